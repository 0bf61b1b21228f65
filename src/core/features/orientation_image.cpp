#include "core/features/orientation_image.h"

#include <algorithm>
#include <cstddef>

#include "core/simd/kernels.h"

namespace perennial {
namespace {

constexpr int kReach = 2;  // of the smoothing

/// Rows 1 4 6 4 1 summed, into sums[kReach..]; the ends repeated beyond the edges.
void smoothColumns(const cv::Mat& image, int y, std::uint16_t* __restrict sums) {
  const auto row = [&](int at) { return image.ptr<std::uint8_t>(std::clamp(at, 0, image.rows - 1)); };
  const std::uint8_t* const a = row(y - 2);
  const std::uint8_t* const b = row(y - 1);
  const std::uint8_t* const c = row(y);
  const std::uint8_t* const d = row(y + 1);
  const std::uint8_t* const e = row(y + 2);
  std::uint16_t* const __restrict inner = sums + kReach;
  for (int x = 0; x < image.cols; ++x) {
    inner[x] = static_cast<std::uint16_t>(a[x] + 4 * b[x] + 6 * c[x] + 4 * d[x] + e[x]);
  }
  std::fill_n(sums, kReach, inner[0]);
  std::fill_n(inner + image.cols, kReach, inner[image.cols - 1]);
}

void smoothRow(const std::uint16_t* sums, int count, std::uint16_t* __restrict smoothed) {
  for (int x = 0; x < count; ++x) {
    const int sum = sums[x] + 4 * sums[x + 1] + 6 * sums[x + 2] + 4 * sums[x + 3] + sums[x + 4];
    smoothed[x] = static_cast<std::uint16_t>((sum + 8) >> 4);
  }
}

}  // namespace

void orientationRow(const std::uint16_t* up, const std::uint16_t* here, const std::uint16_t* down, int count,
                    std::uint8_t* __restrict cosine, std::uint8_t* __restrict sine) noexcept {
  for (int i = 0; i < count; ++i) {
    const auto dx =
        static_cast<float>((up[i + 2] - up[i]) + 2 * (here[i + 2] - here[i]) + (down[i + 2] - down[i]));
    const auto dy =
        static_cast<float>((down[i] - up[i]) + 2 * (down[i + 1] - up[i + 1]) + (down[i + 2] - up[i + 2]));
    const float xx = dx * dx;
    const float yy = dy * dy;
    const float xy = dx * dy;
    const float scale = 127.0F / ((xx + yy) + kOrientationNoise);
    cosine[i] = static_cast<std::uint8_t>(static_cast<int>((xx - yy) * scale + 128.0F));
    sine[i] = static_cast<std::uint8_t>(static_cast<int>((xy + xy) * scale + 128.0F));
  }
}

void OrientationImages::compute(const cv::Mat& image) {
  cosine_.create(image.rows, image.cols, CV_8UC1);
  sine_.create(image.rows, image.cols, CV_8UC1);
  if (image.empty()) {
    return;
  }
  smooth(image);
  const auto orientation_row = kernels().orientation_row;
  for (int y = 0; y < image.rows; ++y) {
    orientation_row(smoothed_.ptr<std::uint16_t>(y), smoothed_.ptr<std::uint16_t>(y + 1),
                    smoothed_.ptr<std::uint16_t>(y + 2), image.cols, cosine_.ptr<std::uint8_t>(y),
                    sine_.ptr<std::uint8_t>(y));
  }
}

void OrientationImages::smooth(const cv::Mat& image) {
  const int columns = image.cols;
  sums_.resize(static_cast<std::size_t>(columns + 2 * kReach));
  smoothed_.create(image.rows + 2, columns + 2, CV_16UC1);
  for (int y = 0; y < image.rows; ++y) {
    std::uint16_t* const row = smoothed_.ptr<std::uint16_t>(y + 1);
    smoothColumns(image, y, sums_.data());
    smoothRow(sums_.data(), columns, row + 1);
    row[0] = row[1];
    row[columns + 1] = row[columns];
  }
  const auto copyRow = [&](int from, int to) {
    const std::uint16_t* const row = smoothed_.ptr<std::uint16_t>(from);
    std::copy(row, row + columns + 2, smoothed_.ptr<std::uint16_t>(to));
  };
  copyRow(1, 0);
  copyRow(image.rows, image.rows + 1);
}

}  // namespace perennial
