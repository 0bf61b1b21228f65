#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace perennial {

/// Random texture with structure of every size from 2 px to a quarter of the image, mean 128, the same for
/// the same seed.
inline cv::Mat texture(int columns, int rows, std::uint64_t seed, double contrast = 25.0) {
  cv::RNG random(seed);
  cv::Mat sum(rows, columns, CV_32F, cv::Scalar(128.0));
  for (int cell = 2; cell <= std::max(2, std::min(columns, rows) / 4); cell *= 2) {
    cv::Mat coarse(rows / cell + 2, columns / cell + 2, CV_32F);
    random.fill(coarse, cv::RNG::NORMAL, 0.0, contrast);
    cv::Mat fine;
    cv::resize(coarse, fine, {coarse.cols * cell, coarse.rows * cell}, 0.0, 0.0, cv::INTER_CUBIC);
    sum += fine(cv::Rect(0, 0, columns, rows));
  }
  cv::Mat image;
  sum.convertTo(image, CV_8U);
  return image;
}

/// Independent pixels.
inline cv::Mat noise(int columns, int rows, std::uint64_t seed, double mean, double deviation) {
  cv::RNG random(seed);
  cv::Mat values(rows, columns, CV_32F);
  random.fill(values, cv::RNG::NORMAL, mean, deviation);
  cv::Mat image;
  values.convertTo(image, CV_8U);
  return image;
}

/// Adds a Gaussian blob.
inline void addBlob(cv::Mat& image, double x, double y, double sigma, double height) {
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const double squared = (u - x) * (u - x) + (v - y) * (v - y);
      auto& pixel = image.at<std::uint8_t>(v, u);
      pixel = cv::saturate_cast<std::uint8_t>(pixel + height * std::exp(-0.5 * squared / (sigma * sigma)));
    }
  }
}

}  // namespace perennial
