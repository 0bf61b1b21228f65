#pragma once

#include <cmath>
#include <opencv2/core.hpp>

namespace perennial {

/// The definition of a response, pixel by pixel in double precision, written without looking at the
/// implementation: an oracle for tests. `size`: side of the filter, px, an odd multiple of 3; (x, y): its
/// centre.
class BruteForceHessian {
 public:
  BruteForceHessian(const cv::Mat& image, int size) : image_(image), lobe_(size / 3), half_(size / 2) {}

  /// dxx, dyy and dxy, divided by the area of the filter and by 255.
  struct Derivatives {
    double xx = 0.0;
    double yy = 0.0;
    double xy = 0.0;

    double determinant() const { return xx * yy - 0.81 * xy * xy; }
    double magnitude() const { return std::abs(xx * yy) + 0.81 * xy * xy; }
  };

  Derivatives at(int x, int y) const {
    Derivatives sums;
    for (int v = -half_; v <= half_; ++v) {
      for (int u = -half_; u <= half_; ++u) {
        const double pixel = image_.at<std::uint8_t>(y + v, x + u);
        sums.xx += secondWeight(u, v) * pixel;
        sums.yy += secondWeight(v, u) * pixel;
        sums.xy += mixedWeight(u, v) * pixel;
      }
    }
    const double norm = 255.0 * (3.0 * lobe_) * (3.0 * lobe_);
    return {sums.xx / norm, sums.yy / norm, sums.xy / norm};
  }

 private:
  double secondWeight(int along, int across) const {
    if (std::abs(across) >= lobe_) {
      return 0.0;
    }
    return std::abs(along) <= lobe_ / 2 ? -2.0 : 1.0;
  }

  double mixedWeight(int u, int v) const {
    if (u == 0 || v == 0 || std::abs(u) > lobe_ || std::abs(v) > lobe_) {
      return 0.0;
    }
    return (u > 0) == (v > 0) ? 1.0 : -1.0;
  }

  cv::Mat image_;
  int lobe_;
  int half_;
};

}  // namespace perennial
