#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "perennial/core/parameter_reader.h"
#include "perennial/park/random.h"
#include "perennial/park/renderer.h"

namespace perennial::park {

struct CameraSettings {
  CameraGeometry geometry;
  double height_m = 0.6;   ///< of the camera above ground
  double forward_m = 0.2;  ///< of the camera from the robot's middle
  double exposure_max_ms = 20.0;
  double exposure_min_ms = 0.05;
  double gain_max_db = 24.0;
  double target_brightness = 0.42;  ///< mean of the image that the automatic exposure aims at, [0, 1]
  double adaptation = 0.35;         ///< share of the difference that it makes up for with each image
  double noise = 1.0;               ///< 0: none; 1: a usual camera's
  double motion_blur = 1.0;         ///< 0: none; 1: that of the exposure time
  double jolt_deg = 0.25;           ///< how far the uneven ground tilts the camera, standard deviation

  /// Keys: width, height, horizontal_fov_deg, camera_height_m, camera_forward_m and the members' names.
  /// Throws ParameterError.
  static CameraSettings load(ParameterReader& reader);
};

/// A camera's automatic exposure: exposure time first, gain when that does not suffice.
struct ExposureState {
  double time_ms = 1.0;
  double gain = 1.0;  ///< factor, at least 1
  bool settled = false;
};

/// Makes an image of a camera of what the renderer gives: exposure with saturation, motion blur, noise,
/// gamma. Holds the state of the automatic exposure. Not thread-safe.
class CameraModel {
 public:
  CameraModel(const CameraSettings& settings, std::uint64_t seed);

  /// What the renderer's `exposure` must be for the next image.
  double exposure() const;
  /// The image, CV_8UC1 or (colour) CV_8UC3 blue-green-red. `rendered`: Renderer's output with exposure().
  /// `turn_rate`: rad/s, left positive. `number`: of the image, chooses its noise. Then adapts the exposure.
  cv::Mat develop(const cv::Mat& rendered, double turn_rate, std::int64_t number, bool colour);

  const ExposureState& state() const { return state_; }
  const CameraSettings& settings() const { return settings_; }

 private:
  void adapt(const cv::Mat& image);
  void addNoise(cv::Mat& light, std::int64_t number) const;
  double blurLength(double turn_rate) const;

  CameraSettings settings_;
  std::uint64_t seed_;
  ExposureState state_;
  cv::Mat noise_bank_;  ///< standard normal numbers, CV_32FC1
};

}  // namespace perennial::park
