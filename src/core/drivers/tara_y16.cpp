#include "perennial/core/drivers/tara_y16.h"

namespace perennial {

void splitY16(const std::uint8_t* words, std::size_t pixels, std::uint8_t* __restrict left,
              std::uint8_t* __restrict right) noexcept {
  for (std::size_t i = 0; i < pixels; ++i) {
    left[i] = words[2 * i];
    right[i] = words[2 * i + 1];
  }
}

void mergeY16(const std::uint8_t* left, const std::uint8_t* right, std::size_t pixels,
              std::uint8_t* __restrict words) noexcept {
  for (std::size_t i = 0; i < pixels; ++i) {
    words[2 * i] = left[i];
    words[2 * i + 1] = right[i];
  }
}

double upperHalfMean(const std::uint8_t* view, std::size_t width, std::size_t height) noexcept {
  const std::size_t count = width * (height / 2);
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    sum += view[i];
  }
  return count == 0 ? 0.0 : static_cast<double>(sum) / static_cast<double>(count);
}

}  // namespace perennial
