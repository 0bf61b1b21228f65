#include "core/features/box_sums.h"

#include "core/simd/kernels.h"

namespace perennial {

void boxSumRow(const std::uint32_t* above, const std::uint32_t* below, int side, int count,
               std::uint16_t* __restrict sums) noexcept {
  for (int x = 0; x < count; ++x) {
    sums[x] = static_cast<std::uint16_t>((below[x + side] - below[x]) - (above[x + side] - above[x]));
  }
}

void BoxSums::compute(const IntegralImage& integral) {
  const int rows = integral.rows();
  columns_ = integral.columns();
  const auto stride = static_cast<std::size_t>(columns_);
  sums_.resize(stride * static_cast<std::size_t>(rows));
  const auto box_sum_row = kernels().box_sum_row;
  constexpr int kHalf = kSide / 2;
  for (int y = kHalf; y < rows - kHalf; ++y) {
    std::uint16_t* const sums = sums_.data() + static_cast<std::size_t>(y) * stride + kHalf;
    box_sum_row(integral.row(y - kHalf), integral.row(y + kHalf + 1), kSide, columns_ - 2 * kHalf, sums);
  }
}

}  // namespace perennial
