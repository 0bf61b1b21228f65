// The checksum of map files is CRC-32, whatever the lengths of the pieces that are added.
#include "core/map/row_checksum.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace perennial {
namespace {

/// Bit by bit, as the definition reads.
std::uint32_t slowly(const std::vector<std::uint8_t>& bytes) {
  std::uint32_t remainder = 0xFFFFFFFFU;
  for (const std::uint8_t byte : bytes) {
    remainder ^= byte;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder & 1U) != 0 ? (remainder >> 1) ^ 0xEDB88320U : remainder >> 1;
    }
  }
  return ~remainder;
}

TEST(RowChecksum, isTheOneOfPngAndZip) {
  EXPECT_EQ(RowChecksum().value(), 0U);
  EXPECT_EQ(RowChecksum().addBytes("123456789", 9).value(), 0xCBF43926U);  // the value every catalogue gives
}

TEST(RowChecksum, isTheSlowOneAtEveryLengthAndPlace) {
  std::mt19937 random(1);
  std::vector<std::uint8_t> bytes(200);
  for (auto& byte : bytes) {
    byte = static_cast<std::uint8_t>(random());
  }
  for (std::size_t size = 0; size < 70; ++size) {
    for (std::size_t begin = 0; begin < 20; ++begin) {
      const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(begin);
      const std::vector<std::uint8_t> part(first, first + static_cast<std::ptrdiff_t>(size));
      EXPECT_EQ(RowChecksum().addBytes(bytes.data() + begin, size).value(), slowly(part)) << size;
    }
  }
}

TEST(RowChecksum, isThatOfAllPiecesTogether) {
  std::vector<std::uint8_t> all{7, 0, 0, 0, 3, 0, 0, 0, 'a', 'b', 'c'};
  RowChecksum checksum;
  checksum.add(std::uint32_t{7}).add(std::string("abc"));
  EXPECT_EQ(checksum.value(), slowly(all));
  for (int piece = 1; piece < 60; ++piece) {
    const std::vector<std::uint8_t> more(static_cast<std::size_t>(piece), static_cast<std::uint8_t>(piece));
    all.insert(all.end(), more.begin(), more.end());
    EXPECT_EQ(checksum.addBytes(more.data(), more.size()).value(), slowly(all)) << piece;
  }
}

}  // namespace
}  // namespace perennial
