#pragma once

#include <cmath>

#include "perennial/core/feature.h"

namespace perennial {

/// The pixel nearest to a keypoint, around which it is described.
struct Pixel {
  int x = 0;
  int y = 0;
};

inline Pixel nearestPixel(const Keypoint& keypoint) {
  return {static_cast<int>(std::lround(keypoint.x)), static_cast<int>(std::lround(keypoint.y))};
}

/// Pixels that a descriptor reads around its centre. Keypoints nearer to the image's edge are not described.
struct PatchMargin {
  int before = 0;  ///< to the left and above
  int after = 0;   ///< to the right and below

  bool fits(const Pixel& centre, int columns, int rows) const {
    return centre.x >= before && centre.y >= before && centre.x + after < columns && centre.y + after < rows;
  }
};

}  // namespace perennial
