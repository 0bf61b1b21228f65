#include "core/features/half_image.h"

#include <cstdint>

namespace perennial {

void halveImage(const cv::Mat& image, cv::Mat& half) {
  half.create(image.rows / 2, image.cols / 2, CV_8UC1);
  for (int y = 0; y < half.rows; ++y) {
    const std::uint8_t* const upper = image.ptr<std::uint8_t>(2 * y);
    const std::uint8_t* const lower = image.ptr<std::uint8_t>(2 * y + 1);
    std::uint8_t* const __restrict row = half.ptr<std::uint8_t>(y);
    for (int x = 0; x < half.cols; ++x) {
      row[x] = static_cast<std::uint8_t>(
          (upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1] + 2) / 4);
    }
  }
}

}  // namespace perennial
