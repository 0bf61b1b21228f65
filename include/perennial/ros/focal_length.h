#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <cmath>
#include <optional>

namespace perennial {

/// The focal length in pixels of images of this width; a camera may deliver them in another size than it was
/// calibrated with. Empty without a calibration, or with one that cannot be.
inline std::optional<double> focalLength(const sensor_msgs::CameraInfoConstPtr& info, int image_width) {
  if (!info || !(std::isfinite(info->K[0]) && info->K[0] > 0.0) || info->width == 0) {
    return std::nullopt;
  }
  return info->K[0] * image_width / info->width;
}

}  // namespace perennial
