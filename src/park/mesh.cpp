#include "mesh.h"

#include <algorithm>
#include <cmath>

namespace perennial::park {
namespace {

unsigned char byteOf(double share) {
  return static_cast<unsigned char>(std::lround(255.0 * std::clamp(share, 0.0, 1.0)));
}

Vec3 unit(Vec3 vector) {
  vector.normalize();
  return vector;
}

}  // namespace

Mesh::Mesh()
    : positions_(new osg::Vec3Array),
      normals_(new osg::Vec3Array),
      coordinates_(new osg::Vec2Array),
      colours_(new osg::Vec4ubArray),
      indices_(new osg::DrawElementsUInt(GL_TRIANGLES)) {}

unsigned Mesh::add(const Vertex& vertex) {
  positions_->push_back(osg::Vec3f(vertex.position));
  normals_->push_back(osg::Vec3f(vertex.normal));
  coordinates_->push_back({static_cast<float>(vertex.u), static_cast<float>(vertex.v)});
  // Eight bits hold the dark greens of leaves better when the square root is stored.
  colours_->push_back({byteOf(std::sqrt(vertex.colour[0])), byteOf(std::sqrt(vertex.colour[1])),
                       byteOf(std::sqrt(vertex.colour[2])), byteOf(vertex.sway)});
  return static_cast<unsigned>(positions_->size() - 1);
}

void Mesh::triangle(const Vertex& a, const Vertex& b, const Vertex& c) {
  for (const Vertex* vertex : {&a, &b, &c}) {
    indices_->push_back(add(*vertex));
  }
}

void Mesh::quad(const Vertex& a, const Vertex& b, const Vertex& c, const Vertex& d) {
  const unsigned first = add(a);
  add(b);
  add(c);
  add(d);
  for (const unsigned corner : {0U, 1U, 2U, 0U, 2U, 3U}) {
    indices_->push_back(first + corner);
  }
}

osg::ref_ptr<osg::Geometry> Mesh::geometry() {
  osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry;
  geometry->setUseDisplayList(false);
  geometry->setUseVertexBufferObjects(true);
  colours_->setNormalize(true);
  geometry->setVertexArray(positions_);
  geometry->setNormalArray(normals_, osg::Array::BIND_PER_VERTEX);
  geometry->setTexCoordArray(0, coordinates_, osg::Array::BIND_PER_VERTEX);
  geometry->setColorArray(colours_, osg::Array::BIND_PER_VERTEX);
  geometry->addPrimitiveSet(indices_);
  return geometry;
}

std::array<double, 2> atlasCoordinates(Tile tile, double u, double v) {
  constexpr double kInset = 0.01;  // keeps the neighbouring tile out of the smaller mipmaps
  const int index = static_cast<int>(tile);
  const auto inside = [](double share) { return kInset + (1.0 - 2.0 * kInset) * share; };
  return {(index % kAtlasColumns + inside(u)) / kAtlasColumns,
          (index / kAtlasColumns + inside(v)) / kAtlasRows};
}

void addPanel(Mesh& mesh, const Vec3& corner, const Vec3& along, const Vec3& up, const Vec3& normal,
              Tile tile, double tile_m, const Colour& colour) {
  const int columns = std::max(1, static_cast<int>(std::lround(along.length() / tile_m)));
  const int rows = std::max(1, static_cast<int>(std::lround(up.length() / tile_m)));
  const double u_end =
      std::min(1.0, along.length() / tile_m);  // a panel smaller than a tile shows part of it
  const double v_end = std::min(1.0, up.length() / tile_m);
  const auto vertex = [&](int column, int row, double u, double v) {
    const auto uv = atlasCoordinates(tile, u, v);
    return Mesh::Vertex{corner + along * (1.0 * column / columns) + up * (1.0 * row / rows),
                        normal,
                        uv[0],
                        uv[1],
                        colour,
                        0.0};
  };
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      mesh.quad(vertex(i, j, 0.0, v_end), vertex(i + 1, j, u_end, v_end), vertex(i + 1, j + 1, u_end, 0.0),
                vertex(i, j + 1, 0.0, 0.0));
    }
  }
}

void addTube(Mesh& mesh, const Vec3& from, const Vec3& to, double from_radius, double to_radius, int sides,
             Tile tile, const Colour& colour) {
  const Vec3 axis = unit(to - from);
  const Vec3 side = unit(axis ^ (std::abs(axis.z()) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0)));
  const Vec3 other = axis ^ side;
  const int rows = std::max(1, static_cast<int>((to - from).length() / 1.5));
  const auto vertex = [&](int i, double share, double v) {
    const double angle = 2.0 * 3.14159265358979323846 * i / sides;
    const Vec3 normal = side * std::cos(angle) + other * std::sin(angle);
    const double radius = from_radius + (to_radius - from_radius) * share;
    const auto uv = atlasCoordinates(tile, std::min(1.0, 1.0 * i / sides), v);
    return Mesh::Vertex{from + (to - from) * share + normal * radius, normal, uv[0], uv[1], colour, 0.0};
  };
  for (int row = 0; row < rows; ++row) {
    for (int i = 0; i < sides; ++i) {
      const double low = 1.0 * row / rows;
      const double high = 1.0 * (row + 1) / rows;
      mesh.quad(vertex(i, low, 1.0), vertex(i + 1, low, 1.0), vertex(i + 1, high, 0.0), vertex(i, high, 0.0));
    }
  }
}

}  // namespace perennial::park
