#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
              "map files are little-endian, as is every robot computer");

namespace perennial {

/// CRC-32 (the one of PNG and zip) over the values of one row, in the order in which they are added. Numbers
/// count as their little-endian bytes, texts as their length and their bytes. docs/map_format.md lists what
/// each row adds.
class RowChecksum {
 public:
  RowChecksum& add(std::uint32_t value) { return addBytes(&value, sizeof(value)); }
  RowChecksum& add(double value) { return addBytes(&value, sizeof(value)); }
  RowChecksum& add(const std::string& text) {
    add(static_cast<std::uint32_t>(text.size()));
    return addBytes(text.data(), text.size());
  }
  RowChecksum& addBytes(const void* bytes, std::size_t size);

  std::uint32_t value() const { return ~remainder_; }

 private:
  std::uint32_t remainder_ = 0xFFFFFFFFU;
};

}  // namespace perennial
