#include "perennial/park/renderer.h"

#include <cmath>
#include <opencv2/core.hpp>
#include <osgUtil/RenderBin>
#include <osgViewer/Viewer>

#include "headless_gl.h"
#include "park_scene.h"
#include "perennial/core/error.h"
#include "shaders.h"

namespace perennial::park {
namespace {

constexpr int kShadowMapPx = 4096;  // 1 cm on the ground
constexpr double kNearM = 0.1;
constexpr double kFarM = 160.0;

osg::Matrixd projectionOf(const CameraGeometry& g) {
  const double left = -(g.cx + 0.5) / g.fx;
  const double right = (g.width - 0.5 - g.cx) / g.fx;
  const double bottom = -(g.height - 0.5 - g.cy) / g.fy;
  const double top = (g.cy + 0.5) / g.fy;
  return osg::Matrixd::frustum(left * kNearM, right * kNearM, bottom * kNearM, top * kNearM, kNearM, kFarM);
}

osg::Matrixd viewOf(const CameraPose& pose) {
  const osg::Vec3d eye(pose.x, pose.y, pose.z);
  const osg::Vec3d forward(std::cos(pose.heading) * std::cos(pose.pitch),
                           std::sin(pose.heading) * std::cos(pose.pitch), std::sin(pose.pitch));
  const osg::Matrixd level = osg::Matrixd::lookAt(eye, eye + forward, {0.0, 0.0, 1.0});
  return level *
         osg::Matrixd::rotate(pose.roll,
                              osg::Vec3d(0.0, 0.0, 1.0));  // A camera rolled right sees the world roll left.
}

}  // namespace

class Renderer::Implementation {
 public:
  Implementation(const LoopPath& path, const CameraGeometry& geometry)
      : path_(path), geometry_(geometry), gl_(geometry.width, geometry.height) {
    gl_.makeCurrent();
    // Before the viewer makes its bins: with the near things drawn first, most of the far ones need no
    // shading.
    osgUtil::RenderBin::setDefaultRenderBinSortMode(osgUtil::RenderBin::SORT_FRONT_TO_BACK);
    viewer_ = new osgViewer::Viewer;
    viewer_->setThreadingModel(osgViewer::Viewer::SingleThreaded);
    viewer_->setUpViewerAsEmbeddedInWindow(0, 0, geometry.width, geometry.height);
    viewer_->setKeyEventSetsDone(0);
    viewer_->setReleaseContextAtEndOfFrameHint(false);
    viewer_->setLightingMode(osg::View::NO_LIGHT);
    osg::Camera* camera = viewer_->getCamera();
    camera->setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
    camera->setCullingMode(osg::CullSettings::VIEW_FRUSTUM_CULLING);
    camera->setProjectionMatrix(projectionOf(geometry));
    camera->setViewport(0, 0, geometry.width, geometry.height);
  }

  ~Implementation() {
    gl_.makeCurrent();
    viewer_->setSceneData(nullptr);
    scene_.reset();
    viewer_->getCamera()->getGraphicsContext()->close();
  }

  const cv::Mat& render(const Conditions& conditions, const CameraPose& pose, double exposure) {
    gl_.makeCurrent();
    if (!scene_ || !scene_->suits(conditions)) {
      scene_ = std::make_unique<ParkScene>(path_, conditions, kShadowMapPx);
      viewer_->setSceneData(scene_->root());
    }
    scene_->prepare(conditions, pose, geometry_, exposure);
    viewer_->getCamera()->setViewMatrix(viewOf(pose));
    viewer_->frame(0.0);
    raw_.create(geometry_.height, geometry_.width, CV_8UC4);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, geometry_.width, geometry_.height, GL_BGRA, GL_UNSIGNED_BYTE, raw_.data);
    cv::flip(raw_, image_, 0);  // OpenGL counts rows from below.
    return image_;
  }

 private:
  const LoopPath& path_;
  CameraGeometry geometry_;
  HeadlessGl gl_;
  osg::ref_ptr<osgViewer::Viewer> viewer_;
  std::unique_ptr<ParkScene> scene_;
  cv::Mat raw_, image_;
};

Renderer::Renderer(const LoopPath& path, const CameraGeometry& geometry)
    : implementation_(std::make_unique<Implementation>(path, geometry)) {}

Renderer::~Renderer() = default;

const cv::Mat& Renderer::render(const Conditions& conditions, const CameraPose& pose, double exposure) {
  return implementation_->render(conditions, pose, exposure);
}

}  // namespace perennial::park
