#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace perennial {

/// Which way the edges of an image run, whatever their contrast: cosine and sine of twice the angle of the
/// gradient, as two 8-bit images (128: neither way, or no edge). Twice the angle, so that an edge from dark
/// to bright is the same as one from bright to dark: snow, low sun and searchlights turn contrasts over,
/// edges stay (Bigun and Granlund, ICCV 1987, for the representation).
///
/// With gradient (x, y) of the smoothed image: 128 + 127 (x^2 - y^2) / (x^2 + y^2 + n^2) and
/// 128 + 127 * 2 x y / (x^2 + y^2 + n^2), rounded down. n = 2 grey levels per px, above sensors' noise.
/// Smoothing is by the binomial 1 4 6 4 1 (deviation 1 px) in both directions, derivatives are Sobel's;
/// beyond its edge the image goes on as at the edge.
class OrientationImages {
 public:
  /// `image`: CV_8UC1, may be empty. Memory is kept and used again.
  void compute(const cv::Mat& image);

  const cv::Mat& cosine() const { return cosine_; }  ///< above 128: vertical edges, below: horizontal ones
  const cv::Mat& sine() const {
    return sine_;
  }  ///< above 128: edges rising to the right, below: falling ones

 private:
  void smooth(const cv::Mat& image);

  std::vector<std::uint16_t> sums_;  ///< one column-smoothed row, 2 px more on either side
  cv::Mat smoothed_;                 ///< CV_16UC1, 16 times the grey level; 1 px more on every side
  cv::Mat cosine_;
  cv::Mat sine_;
};

/// One row of both images from three rows of the smoothed one, each of `count` + 2 values.
void orientationRow(const std::uint16_t* up, const std::uint16_t* here, const std::uint16_t* down, int count,
                    std::uint8_t* cosine, std::uint8_t* sine) noexcept;

/// n^2 in the units of orientationRow(): Sobel's sums weigh 8, grey levels are in sixteenths.
constexpr float kOrientationNoise = 4.0F * 128.0F * 128.0F;

}  // namespace perennial
