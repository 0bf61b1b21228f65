#pragma once

#include <osg/Camera>
#include <osg/Group>
#include <osg/StateSet>
#include <osg/Texture2D>

#include "perennial/park/conditions.h"
#include "perennial/park/lighting.h"
#include "perennial/park/loop_path.h"
#include "perennial/park/park_layout.h"
#include "perennial/park/renderer.h"
#include "perennial/park/season.h"
#include "terrain.h"

namespace perennial::park {

/// The park as a scene graph, on one day and in one weather; light and time within the day are uniforms.
class ParkScene {
 public:
  /// `shadow_map_size`: side in texels of the square shadow map.
  ParkScene(const LoopPath& path, const Conditions& conditions, int shadow_map_size);

  /// Sets light, wind and camera for one image.
  void prepare(const Conditions& now, const CameraPose& camera, const CameraGeometry& geometry,
               double exposure);

  osg::Group* root() { return root_; }
  /// The scene is good for these conditions, too: same day, park and snow.
  bool suits(const Conditions& conditions) const;

 private:
  void addGround(const Season& season);
  void addObjects(const Season& season);
  void addSky();
  void addShadowMap(int size);
  void updateShadowMap(const Conditions& now, const Lighting& light);
  void setLight(const Conditions& now, const Lighting& light, double exposure);
  void setSkyRays(const CameraPose& camera, const CameraGeometry& geometry);
  template <typename Value>
  void set(const char* name, const Value& value);

  const LoopPath& path_;
  Conditions conditions_;
  Terrain terrain_;
  osg::ref_ptr<osg::Group> root_;
  osg::ref_ptr<osg::Group> casters_;  ///< what throws shadows
  osg::ref_ptr<osg::Camera> shadow_camera_;
  osg::ref_ptr<osg::Texture2D> shadow_map_;
  osg::ref_ptr<osg::Texture2D> ground_texture_;
  osg::Vec3d shadow_direction_;
};

}  // namespace perennial::park
