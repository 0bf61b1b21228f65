#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/features/integral_image.h"

namespace perennial {

/// An image smoothed by a square box, without the division: for descriptors, which only compare. A 9x9 box is
/// the usual replacement of the 9x9 Gaussian kernel of Calonder et al., ECCV 2010.
class BoxSums {
 public:
  static constexpr int kSide = 9;  ///< px

  /// Memory is kept and used again.
  void compute(const IntegralImage& integral);

  /// The sum about a pixel; those of its row beside it, those of its column columns() apart. Nearer than half
  /// a box to the edge they mean nothing.
  const std::uint16_t* at(int x, int y) const {
    return sums_.data() + static_cast<std::ptrdiff_t>(y) * columns_ + x;
  }
  int columns() const { return columns_; }

 private:
  int columns_ = 0;
  std::vector<std::uint16_t> sums_;
};

/// Sums over boxes of `side` px a row, for `count` boxes: `above` and `below` are rows of the integral image.
void boxSumRow(const std::uint32_t* above, const std::uint32_t* below, int side, int count,
               std::uint16_t* sums) noexcept;

}  // namespace perennial
