#pragma once

#include <opencv2/core.hpp>

#include "perennial/core/feature.h"

namespace perennial {

/// The image at half its width and height, rounded down; each pixel is the rounded mean of four. `image`:
/// CV_8UC1. Memory of `half` is used again.
void halveImage(const cv::Mat& image, cv::Mat& half);

/// A keypoint of the halved image, in pixels of the full one. Pixel (0, 0) of the half covers (0, 0) to (1,
/// 1).
inline Keypoint inFullImage(const Keypoint& keypoint) {
  return {2.0F * keypoint.x + 0.5F, 2.0F * keypoint.y + 0.5F, 2.0F * keypoint.scale, keypoint.response};
}

}  // namespace perennial
