#pragma once

#include <array>
#include <osg/Geometry>
#include <osg/Vec3d>

#include "perennial/park/lighting.h"
#include "perennial/park/procedural_textures.h"

namespace perennial::park {

using Vec3 = osg::Vec3d;

/// Collects coloured, textured quads and triangles in the park's frame and makes a drawable of them. Nothing
/// in the park has a transform of its own, so that shaders see the park's coordinates.
class Mesh {
 public:
  struct Vertex {
    Vec3 position;
    Vec3 normal;
    double u = 0.0, v = 0.0;
    Colour colour = {1.0, 1.0, 1.0};  ///< linear albedo, stored as its square root
    double sway = 0.0;                ///< [0, 1]; how much the wind moves it
  };

  Mesh();
  void triangle(const Vertex& a, const Vertex& b, const Vertex& c);
  /// Corners in order around.
  void quad(const Vertex& a, const Vertex& b, const Vertex& c, const Vertex& d);
  bool empty() const { return positions_->empty(); }
  /// The drawable; the mesh must not be used any more.
  osg::ref_ptr<osg::Geometry> geometry();

 private:
  unsigned add(const Vertex& vertex);

  osg::ref_ptr<osg::Vec3Array> positions_, normals_;
  osg::ref_ptr<osg::Vec2Array> coordinates_;
  osg::ref_ptr<osg::Vec4ubArray> colours_;
  osg::ref_ptr<osg::DrawElementsUInt> indices_;
};

/// Texture coordinates in the atlas of a place (u, v) in [0, 1]^2 of a tile; v counts downwards.
std::array<double, 2> atlasCoordinates(Tile tile, double u, double v);

/// A parallelogram covered with a tile, repeated about every `tile_m` metres.
void addPanel(Mesh& mesh, const Vec3& corner, const Vec3& along, const Vec3& up, const Vec3& normal,
              Tile tile, double tile_m, const Colour& colour);

/// A tapered tube without ends, for trunks, branches and posts.
void addTube(Mesh& mesh, const Vec3& from, const Vec3& to, double from_radius, double to_radius, int sides,
             Tile tile, const Colour& colour);

}  // namespace perennial::park
