#include "core/features/brief_descriptor.h"

#include "core/simd/kernels.h"

namespace perennial {

void boxSumRow(const std::uint32_t* above, const std::uint32_t* below, int side, int count,
               std::uint16_t* __restrict sums) noexcept {
  for (int x = 0; x < count; ++x) {
    sums[x] = static_cast<std::uint16_t>((below[x + side] - below[x]) - (above[x + side] - above[x]));
  }
}

void BriefDescriptor::prepare(const IntegralImage& integral) {
  const int rows = integral.rows();
  if (columns_ != integral.columns()) {
    columns_ = integral.columns();
    placePattern();
  }
  const auto stride = static_cast<std::size_t>(columns_);
  smoothed_.resize(stride * static_cast<std::size_t>(rows));
  const auto box_sum_row = kernels().box_sum_row;
  constexpr int kHalf = kSmoothing / 2;
  for (int y = kHalf; y < rows - kHalf; ++y) {
    std::uint16_t* const sums = smoothed_.data() + static_cast<std::size_t>(y) * stride + kHalf;
    box_sum_row(integral.row(y - kHalf), integral.row(y + kHalf + 1), kSmoothing, columns_ - 2 * kHalf, sums);
  }
}

Descriptor BriefDescriptor::describe(const Pixel& centre) const noexcept {
  const std::uint16_t* const at =
      smoothed_.data() + static_cast<std::ptrdiff_t>(centre.y) * columns_ + centre.x;
  Descriptor descriptor;
  for (std::size_t i = 0; i < Descriptor::kBits; ++i) {
    const std::uint64_t bit = at[first_[i]] < at[second_[i]] ? 1 : 0;
    descriptor.words[i / 64] |= bit << (i % 64);
  }
  return descriptor;
}

void BriefDescriptor::placePattern() {
  for (std::size_t i = 0; i < Descriptor::kBits; ++i) {
    const BriefTest& test = kBriefPattern[i];
    first_[i] = static_cast<std::ptrdiff_t>(test.y1) * columns_ + test.x1;
    second_[i] = static_cast<std::ptrdiff_t>(test.y2) * columns_ + test.x2;
  }
}

}  // namespace perennial
