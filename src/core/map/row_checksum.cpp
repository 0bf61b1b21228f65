// Sixteen bytes at a time, each through a table of its own: Kounavis and Berry, "Novel table lookup-based
// algorithms for high-performance CRC generation", IEEE Transactions on Computers 57(11), 2008. A search for
// a place reads a whole map, every byte of which is checked twice.
#include "core/map/row_checksum.h"

#include <array>
#include <cstring>

namespace perennial {
namespace {

constexpr std::size_t kSlices = 16;
constexpr std::uint32_t kPolynomial = 0xEDB88320U;  // reflected

using Tables = std::array<std::array<std::uint32_t, 256>, kSlices>;

/// tables[k][b]: the remainder of byte b with k zero bytes behind it.
constexpr Tables makeTables() {
  Tables tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder >> 1) ^ ((remainder & 1U) != 0 ? kPolynomial : 0U);
    }
    tables[0][byte] = remainder;
  }
  for (std::size_t k = 1; k < kSlices; ++k) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t before = tables[k - 1][byte];
      tables[k][byte] = (before >> 8) ^ tables[0][before & 0xFFU];
    }
  }
  return tables;
}

constexpr Tables kTables = makeTables();

std::uint32_t addSlices(const std::uint8_t* bytes, std::uint32_t remainder) {
  std::array<std::uint32_t, kSlices / 4> words{};
  std::memcpy(words.data(), bytes, kSlices);
  words[0] ^= remainder;
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < kSlices; ++i) {
    sum ^= kTables[kSlices - 1 - i][(words[i / 4] >> (8 * (i % 4))) & 0xFFU];
  }
  return sum;
}

}  // namespace

RowChecksum& RowChecksum::addBytes(const void* bytes, std::size_t size) {
  const auto* next = static_cast<const std::uint8_t*>(bytes);
  const std::uint8_t* const end = next + size;
  for (; end - next >= static_cast<std::ptrdiff_t>(kSlices); next += kSlices) {
    remainder_ = addSlices(next, remainder_);
  }
  for (; next != end; ++next) {
    remainder_ = (remainder_ >> 8) ^ kTables[0][(remainder_ ^ *next) & 0xFFU];
  }
  return *this;
}

}  // namespace perennial
