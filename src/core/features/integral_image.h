#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>

#include "core/simd/aligned_vector.h"

namespace perennial {

/// Summed-area table of an 8-bit image (Viola and Jones, CVPR 2001; Bay et al., CVIU 2008, section 3.1).
///
/// row(y)[x] is the sum of the pixels above row y and left of column x, so there is one row and one column
/// more than in the image, and the sum over rows y0..y1-1 and columns x0..x1-1 is row(y1)[x1] - row(y0)[x1] -
/// row(y1)[x0] + row(y0)[x0]. Arithmetic is modulo 2^32: the table of a huge image may wrap around, its
/// differences are still right for every box whose sum is below 2^31.
class IntegralImage {
 public:
  /// `image`: CV_8UC1, continuous or not, may be empty. Memory is kept and used again.
  void compute(const cv::Mat& image);

  int rows() const { return rows_; }        ///< of the image
  int columns() const { return columns_; }  ///< of the image
  /// So many sums behind the end of a row may be read, but mean nothing.
  static constexpr std::size_t kReadBeyond = 64;

  /// Begins a line of the cache.
  const std::uint32_t* row(int y) const { return sums_.data() + static_cast<std::size_t>(y) * stride_; }

 private:
  int rows_ = 0;
  int columns_ = 0;
  std::size_t stride_ = 1;
  AlignedVector<std::uint32_t> sums_;
};

/// One row of the table: `sums[x + 1] = above[x + 1] + pixels[0] + ... + pixels[x]`, and `sums[0] = 0`.
void integralRow(const std::uint8_t* pixels, const std::uint32_t* above, int columns,
                 std::uint32_t* sums) noexcept;

}  // namespace perennial
