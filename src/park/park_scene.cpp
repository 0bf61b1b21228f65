#include "park_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <osg/CullFace>
#include <osg/Depth>
#include <osg/Geode>

#include "mesh.h"
#include "objects.h"
#include "perennial/park/procedural_textures.h"
#include "perennial/park/random.h"
#include "plants.h"
#include "shaders.h"

namespace perennial::park {
namespace {

constexpr int kGroundTexturePx = 1024;
constexpr int kTilePx = 256;
constexpr double kShadowReachM = 21.0;  ///< from the park's middle; what lies further off throws no shadow
constexpr int kColourUnit = 0;
constexpr int kShadowUnit = 1;
constexpr int kPathUnit = 2;

osg::ref_ptr<osg::Texture2D> textureOf(const cv::Mat& picture, bool repeat) {
  osg::ref_ptr<osg::Image> image = new osg::Image;
  const GLenum format = picture.channels() == 4 ? GL_RGBA : GL_RED;
  image->allocateImage(picture.cols, picture.rows, 1, format, GL_UNSIGNED_BYTE);
  image->setInternalTextureFormat(picture.channels() == 4 ? GL_RGBA8 : GL_R8);
  std::memcpy(image->data(), picture.data, picture.total() * picture.elemSize());
  osg::ref_ptr<osg::Texture2D> texture = new osg::Texture2D(image);
  const auto wrap = repeat ? osg::Texture::REPEAT : osg::Texture::CLAMP_TO_EDGE;
  texture->setWrap(osg::Texture::WRAP_S, wrap);
  texture->setWrap(osg::Texture::WRAP_T, wrap);
  texture->setFilter(osg::Texture::MIN_FILTER, osg::Texture::LINEAR_MIPMAP_NEAREST);
  texture->setFilter(osg::Texture::MAG_FILTER, osg::Texture::LINEAR);
  texture->setResizeNonPowerOfTwoHint(false);
  return texture;
}

osg::Vec3f vectorOf(const std::array<double, 3>& values) {
  return {static_cast<float>(values[0]), static_cast<float>(values[1]), static_cast<float>(values[2])};
}

}  // namespace

ParkScene::ParkScene(const LoopPath& path, const Conditions& conditions, int shadow_map_size)
    : path_(path), conditions_(conditions), terrain_(path), root_(new osg::Group), casters_(new osg::Group) {
  const Season season = seasonOf(conditions);
  addShadowMap(shadow_map_size);
  addObjects(season);
  addGround(season);
  addSky();
  osg::StateSet* state = root_->getOrCreateStateSet();
  state->setTextureAttributeAndModes(kShadowUnit, shadow_map_);
  set("shadow_map", kShadowUnit);
  set("snow", static_cast<float>(season.snow_cover));
}

bool ParkScene::suits(const Conditions& conditions) const {
  return conditions.day() == conditions_.day() && conditions.weather == conditions_.weather &&
         conditions.world_seed == conditions_.world_seed && conditions.wind_m_s == conditions_.wind_m_s;
}

void ParkScene::addObjects(const Season& season) {
  const ParkLayout layout = makeLayout(path_, conditions_.world_seed);
  osg::StateSet* state = casters_->getOrCreateStateSet();
  const osg::ref_ptr<osg::Texture2D> atlas = textureOf(objectAtlas(kTilePx), false);
  state->setTextureAttributeAndModes(kColourUnit, atlas);
  state->setAttributeAndModes(objectProgram());
  state->addUniform(new osg::Uniform("atlas", kColourUnit));
  for (const Plant& plant : layout.plants) {
    casters_->addChild(makePlant(plant, terrain_.height(plant.x, plant.y), conditions_, season));
  }
  for (const Object& object : layout.furniture) {
    casters_->addChild(makeObject(object));
  }
  for (const Object& object : thingsOfDay(layout, conditions_.world_seed, conditions_.day())) {
    casters_->addChild(makeObject(object));
  }
  root_->addChild(casters_);
  // Grass is too fine to throw shadows that a camera could see.
  osg::ref_ptr<osg::Group> grass = terrain_.grass(season, conditions_.world_seed);
  grass->setStateSet(state);
  root_->addChild(grass);
}

void ParkScene::addGround(const Season& season) {
  ground_texture_ = textureOf(groundTexture(kGroundTexturePx), true);
  const osg::ref_ptr<osg::Geometry> ground = terrain_.ground();
  osg::StateSet* state = ground->getOrCreateStateSet();
  state->setAttributeAndModes(groundProgram());
  state->setTextureAttributeAndModes(kColourUnit, ground_texture_);
  state->setTextureAttributeAndModes(kPathUnit, textureOf(terrain_.distancePicture(), false));
  state->addUniform(new osg::Uniform("ground", kColourUnit));
  state->addUniform(new osg::Uniform("path_distance", kPathUnit));
  const cv::Point2d origin = terrain_.origin();
  state->addUniform(new osg::Uniform("path_origin",
                                     osg::Vec2f(static_cast<float>(origin.x), static_cast<float>(origin.y))));
  state->addUniform(new osg::Uniform("path_side", static_cast<float>(Terrain::kSideM)));
  state->addUniform(new osg::Uniform("litter", static_cast<float>(season.litter)));
  state->addUniform(new osg::Uniform("dryness", static_cast<float>(season.grass_dryness)));
  Random today(mix({conditions_.world_seed, conditions_.day(), 55}));  // Leaves lie elsewhere every day.
  state->addUniform(
      new osg::Uniform("litter_shift", osg::Vec2f(static_cast<float>(today.uniform(0.0, 40.0)),
                                                  static_cast<float>(today.uniform(0.0, 40.0)))));
  state->setRenderBinDetails(5, "RenderBin");  // after what hides it
  root_->addChild(ground);
}

void ParkScene::addSky() {
  osg::ref_ptr<osg::Geometry> sky = new osg::Geometry;
  sky->setUseDisplayList(false);
  sky->setUseVertexBufferObjects(true);
  osg::ref_ptr<osg::Vec3Array> corners = new osg::Vec3Array;
  for (const auto& [x, y] : {std::pair{-1.0F, -1.0F}, {1.0F, -1.0F}, {1.0F, 1.0F}, {-1.0F, 1.0F}}) {
    corners->push_back({x, y, 0.0F});
  }
  sky->setVertexArray(corners);
  sky->addPrimitiveSet(new osg::DrawArrays(GL_TRIANGLE_FAN, 0, 4));
  sky->setCullingActive(false);
  osg::StateSet* state = sky->getOrCreateStateSet();
  state->setAttributeAndModes(skyProgram());
  state->setTextureAttributeAndModes(kColourUnit, ground_texture_);
  state->addUniform(new osg::Uniform("ground", kColourUnit));
  state->setAttributeAndModes(new osg::Depth(osg::Depth::LEQUAL, 0.0, 1.0, false));
  state->setRenderBinDetails(10, "RenderBin");  // last: only where nothing else is
  root_->addChild(sky);
}

void ParkScene::addShadowMap(int size) {
  shadow_map_ = new osg::Texture2D;
  shadow_map_->setTextureSize(size, size);
  shadow_map_->setInternalFormat(GL_DEPTH_COMPONENT24);
  shadow_map_->setSourceFormat(GL_DEPTH_COMPONENT);
  shadow_map_->setSourceType(GL_UNSIGNED_INT);
  shadow_map_->setShadowComparison(true);
  shadow_map_->setShadowCompareFunc(osg::Texture::LEQUAL);
  shadow_map_->setFilter(osg::Texture::MIN_FILTER, osg::Texture::LINEAR);
  shadow_map_->setFilter(osg::Texture::MAG_FILTER, osg::Texture::LINEAR);
  shadow_map_->setWrap(osg::Texture::WRAP_S, osg::Texture::CLAMP_TO_EDGE);
  shadow_map_->setWrap(osg::Texture::WRAP_T, osg::Texture::CLAMP_TO_EDGE);

  shadow_camera_ = new osg::Camera;
  shadow_camera_->setReferenceFrame(osg::Camera::ABSOLUTE_RF);
  shadow_camera_->setRenderOrder(osg::Camera::PRE_RENDER);
  shadow_camera_->setRenderTargetImplementation(osg::Camera::FRAME_BUFFER_OBJECT);
  shadow_camera_->setImplicitBufferAttachmentMask(0, 0);
  shadow_camera_->attach(osg::Camera::DEPTH_BUFFER, shadow_map_);
  shadow_camera_->setClearMask(GL_DEPTH_BUFFER_BIT);
  shadow_camera_->setViewport(0, 0, size, size);
  shadow_camera_->setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
  shadow_camera_->setCullingMode(osg::CullSettings::VIEW_FRUSTUM_CULLING);
  shadow_camera_->addChild(casters_);
  shadow_camera_->getOrCreateStateSet()->setAttributeAndModes(
      shadowProgram(), osg::StateAttribute::ON | osg::StateAttribute::OVERRIDE);
  root_->addChild(shadow_camera_);
}

void ParkScene::prepare(const Conditions& now, const CameraPose& camera, const CameraGeometry& geometry,
                        double exposure) {
  const Lighting light = lightingOf(now);
  setLight(now, light, exposure);
  updateShadowMap(now, light);
  setSkyRays(camera, geometry);
}

void ParkScene::setLight(const Conditions& now, const Lighting& light, double exposure) {
  constexpr double kPeriodS = 3600.0;  // keeps the shaders' single precision fine
  set("to_sun", vectorOf(light.to_sun));
  set("sun", vectorOf(light.sun));
  set("sun_visible", light.sun[0] > 0.0 ? 1.0F : 0.0F);
  set("sky", vectorOf(light.sky));
  set("horizon", vectorOf(light.horizon));
  set("searchlight", static_cast<float>(light.searchlight));
  set("haze", static_cast<float>(light.haze_per_m));
  set("wetness", static_cast<float>(light.wetness));
  set("cloud_cover", static_cast<float>(light.cloud_cover));
  // Clouds cross the sky with the wind; where they are also depends on the day.
  const double drift = std::fmod(now.date_time_s * (0.5 + now.wind_m_s) * 4e-5, 1.0);
  set("cloud_drift", static_cast<float>(drift));
  set("time", static_cast<float>(std::fmod(now.date_time_s, kPeriodS)));
  set("wind", static_cast<float>(std::min(now.wind_m_s, 12.0)));
  set("exposure", static_cast<float>(exposure));
}

void ParkScene::updateShadowMap(const Conditions& now, const Lighting& light) {
  const auto towards = shadowDirection(now.date_time_s);
  const osg::Vec3d direction(towards[0], towards[1], towards[2]);
  const bool needed = light.sun[0] > 0.0 && direction != shadow_direction_;
  shadow_camera_->setNodeMask(needed ? ~0U : 0U);
  if (!needed) {
    return;
  }
  shadow_direction_ = direction;
  const cv::Point2d middle = terrain_.origin() + cv::Point2d(Terrain::kSideM, Terrain::kSideM) * 0.5;
  const osg::Vec3d centre(middle.x, middle.y, 0.0);
  shadow_camera_->setViewMatrixAsLookAt(centre + direction * 80.0, centre, {0.0, 0.0, 1.0});
  shadow_camera_->setProjectionMatrixAsOrtho(-kShadowReachM, kShadowReachM, -kShadowReachM, kShadowReachM,
                                             10.0, 150.0);
  const osg::Matrixd to_texture = osg::Matrixd::scale(0.5, 0.5, 0.5) * osg::Matrixd::translate(0.5, 0.5, 0.5);
  set("shadow_matrix",
      osg::Matrixf(shadow_camera_->getViewMatrix() * shadow_camera_->getProjectionMatrix() * to_texture));
}

void ParkScene::setSkyRays(const CameraPose& camera, const CameraGeometry& geometry) {
  const double c = std::cos(camera.heading), s = std::sin(camera.heading);
  const double cp = std::cos(camera.pitch), sp = std::sin(camera.pitch);
  const osg::Vec3d forward(c * cp, s * cp, sp);
  const osg::Vec3d level_right(s, -c, 0.0);
  const osg::Vec3d level_up = level_right ^ forward;
  const osg::Vec3d right = level_right * std::cos(camera.roll) - level_up * std::sin(camera.roll);
  const osg::Vec3d up = level_up * std::cos(camera.roll) + level_right * std::sin(camera.roll);
  const double half_width = 0.5 * geometry.width / geometry.fx;
  const double half_height = 0.5 * geometry.height / geometry.fy;
  const double shift_right = (0.5 * (geometry.width - 1) - geometry.cx) / geometry.fx;
  const double shift_up = (geometry.cy - 0.5 * (geometry.height - 1)) / geometry.fy;
  set("camera", osg::Vec3f(osg::Vec3d(camera.x, camera.y, camera.z)));
  set("camera_forward", osg::Vec3f(forward));
  set("ray_middle", osg::Vec3f(forward + right * shift_right + up * shift_up));
  set("ray_right", osg::Vec3f(right * half_width));
  set("ray_up", osg::Vec3f(up * half_height));
}

template <typename Value>
void ParkScene::set(const char* name, const Value& value) {
  osg::StateSet* state = root_->getOrCreateStateSet();
  osg::Uniform* uniform = state->getUniform(name);
  if (uniform == nullptr) {
    state->addUniform(new osg::Uniform(name, value));
  } else {
    uniform->set(value);
  }
}

}  // namespace perennial::park
