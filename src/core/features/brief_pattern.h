#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "perennial/core/feature.h"

namespace perennial {

/// A binary test compares the smoothed intensities at two places, given relative to the keypoint in px,
/// -24..23.
struct BriefTest {
  std::int8_t x1;
  std::int8_t y1;
  std::int8_t x2;
  std::int8_t y2;
};

/// Side of the described patch, px (S in Calonder et al.).
constexpr int kBriefPatch = 48;

/// The sampling pattern; descriptors in maps depend on it, so it must never change.
///
/// Isotropic Gaussian with sigma = S / 5 = 9.6 px about the keypoint, arrangement G II of Calonder et al.
/// (ECCV 2010, section 3.2). How it was made, in integers, so that it can be made again anywhere (a test
/// does):
///
///  - random 16-bit numbers: the upper 16 bits of s after s = 6364136223846793005 s + 1442695040888963407
///    (mod 2^64, s = 0 before the first step);
///  - a coordinate: t = the sum of 12 such numbers less 393210, which is nearly normal with deviation 65536;
///    the coordinate is floor(t * 96 / 655360 + 1/2), drawn again until it is within -24..23;
///  - a test: x1, y1, x2, y2 in this order, drawn again when both places are the same.
extern const std::array<BriefTest, Descriptor::kBits> kBriefPattern;

/// The pattern's places in an image of some width, as offsets from the keypoint's pixel.
class BriefOffsets {
 public:
  void place(int columns);

  /// Whether the value at the first place of test `i` is less than at the second.
  std::uint64_t test(std::size_t i, const std::uint16_t* centre) const noexcept {
    return centre[first_[i]] < centre[second_[i]] ? 1 : 0;
  }

 private:
  int columns_ = 0;
  std::array<std::ptrdiff_t, Descriptor::kBits> first_{};
  std::array<std::ptrdiff_t, Descriptor::kBits> second_{};
};

}  // namespace perennial
