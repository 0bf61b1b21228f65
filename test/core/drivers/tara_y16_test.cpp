#include "perennial/core/drivers/tara_y16.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace perennial {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(TaraY16, evenBytesAreTheLeftView) {
  const Bytes words = {1, 10, 2, 20, 3, 30};
  Bytes left(3);
  Bytes right(3);
  splitY16(words.data(), 3, left.data(), right.data());
  EXPECT_EQ(left, (Bytes{1, 2, 3}));
  EXPECT_EQ(right, (Bytes{10, 20, 30}));
}

TEST(TaraY16, splitsEverySizeAndStaysWithinIt) {
  std::mt19937 random(5);
  for (std::size_t pixels = 0; pixels < 200; ++pixels) {
    Bytes words(2 * pixels);
    for (std::uint8_t& byte : words) {
      byte = static_cast<std::uint8_t>(random());
    }
    Bytes left(pixels + 1, 77);
    Bytes right(pixels + 1, 88);
    splitY16(words.data(), pixels, left.data(), right.data());
    for (std::size_t i = 0; i < pixels; ++i) {
      ASSERT_EQ(left[i], words[2 * i]);
      ASSERT_EQ(right[i], words[2 * i + 1]);
    }
    EXPECT_EQ(left[pixels], 77);
    EXPECT_EQ(right[pixels], 88);
    Bytes merged(2 * pixels);
    mergeY16(left.data(), right.data(), pixels, merged.data());
    EXPECT_EQ(merged, words);
  }
}

TEST(TaraY16, meanOfTheUpperHalf) {
  const Bytes view = {10, 20, 30, 40, 200, 200, 200, 200};
  EXPECT_DOUBLE_EQ(upperHalfMean(view.data(), 2, 4), 25.0);
  EXPECT_DOUBLE_EQ(upperHalfMean(view.data(), 4, 1), 0.0) << "no upper half";
}

}  // namespace
}  // namespace perennial
