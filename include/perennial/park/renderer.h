#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "perennial/park/conditions.h"
#include "perennial/park/loop_path.h"

namespace perennial::park {

/// Where the camera is: optical centre in the park's frame (m), heading counter-clockwise from x, pitch
/// upwards, roll to the right (rad).
struct CameraPose {
  double x = 0.0, y = 0.0, z = 0.6;
  double heading = 0.0;
  double pitch = 0.0;
  double roll = 0.0;
};

/// A pinhole camera without distortion, px. Pixel (0, 0) is the middle of the upper left pixel.
struct CameraGeometry {
  int width = 752;
  int height = 480;
  double fx = 579.0, fy = 579.0;  ///< 66 degrees wide
  double cx = 375.5, cy = 239.5;
};

/// Renders the park without a screen (OpenSceneGraph on Mesa's software renderer). The same conditions, pose
/// and exposure give the same image to the byte on one machine, whatever was rendered before. All calls must
/// come from one thread, the destructor's included.
class Renderer {
 public:
  /// The path must outlive the renderer. Throws Error when there is no OpenGL.
  Renderer(const LoopPath& path, const CameraGeometry& geometry);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// CV_8UC4, valid until the next call: channels 0 to 2 blue, green, red, channel 3 brightness; each
  /// 255 * sqrt(radiance * exposure / kEncodedWhite), see decode tables in camera_model.cpp. The first image
  /// of a day takes about a second longer, because the park is built for it.
  const cv::Mat& render(const Conditions& conditions, const CameraPose& pose, double exposure);

  /// Radiance * exposure that a rendered pixel of 255 stands for; the camera saturates at 1.
  static constexpr double kEncodedWhite = 2.0;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace perennial::park
