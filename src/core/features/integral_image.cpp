#include "core/features/integral_image.h"

#include <algorithm>

#include "core/simd/kernels.h"

namespace perennial {

void integralRow(const std::uint8_t* pixels, const std::uint32_t* above, int columns,
                 std::uint32_t* sums) noexcept {
  std::uint32_t row_sum = 0;
  sums[0] = 0;
  for (int x = 0; x < columns; ++x) {
    row_sum += pixels[x];
    sums[x + 1] = above[x + 1] + row_sum;
  }
}

void IntegralImage::compute(const cv::Mat& image) {
  rows_ = image.rows;
  columns_ = image.cols;
  stride_ = wholeLines<std::uint32_t>(static_cast<std::size_t>(columns_) + 1);
  sums_.resize(stride_ * (static_cast<std::size_t>(rows_) + 1) + kReadBeyond);
  std::fill_n(sums_.begin(), stride_, 0U);
  const auto integral_row = kernels().integral_row;
  for (int y = 0; y < rows_; ++y) {
    std::uint32_t* const above = sums_.data() + static_cast<std::size_t>(y) * stride_;
    integral_row(image.ptr<std::uint8_t>(y), above, columns_, above + stride_);
  }
}

}  // namespace perennial
