#include "perennial/core/evaluation/disturbance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <opencv2/imgproc.hpp>

#include "perennial/core/error.h"

namespace perennial {
namespace {

struct KindName {
  Disturbance::Kind kind;
  const char* name;
  double largest;  ///< amount
};

constexpr std::array<KindName, 5> kKinds{{{Disturbance::Kind::kCover, "cover", 1.0},
                                          {Disturbance::Kind::kBlur, "blur", 1000.0},
                                          {Disturbance::Kind::kRoll, "roll", 90.0},
                                          {Disturbance::Kind::kPitch, "pitch", 45.0},
                                          {Disturbance::Kind::kSaturate, "saturate", 1.0}}};

/// Focal length over the image's width for a field of view of 70 degrees.
constexpr double kFocalShare = 0.714;

/// Structure of every size from 4 px to a quarter of the object: plenty of features.
cv::Mat objectTexture(const cv::Size& size, cv::RNG& random) {
  cv::Mat sum(size, CV_32F, cv::Scalar(random.uniform(60.0, 190.0)));
  for (int cell = 4; cell <= std::max(4, std::min(size.width, size.height) / 4); cell *= 2) {
    cv::Mat coarse(size.height / cell + 2, size.width / cell + 2, CV_32F);
    random.fill(coarse, cv::RNG::NORMAL, 0.0, 25.0);
    cv::Mat fine;
    cv::resize(coarse, fine, {coarse.cols * cell, coarse.rows * cell}, 0.0, 0.0, cv::INTER_NEAREST);
    sum += fine(cv::Rect({0, 0}, size));
  }
  cv::Mat texture;
  sum.convertTo(texture, CV_8U);
  return texture;
}

cv::Mat covered(const cv::Mat& image, double share, cv::RNG& random) {
  const double side = std::sqrt(share);
  const cv::Size size(static_cast<int>(std::lround(side * image.cols)),
                      static_cast<int>(std::lround(side * image.rows)));
  cv::Mat result = image.clone();
  if (size.area() > 0) {
    const cv::Point corner(random.uniform(0, image.cols - size.width + 1),
                           random.uniform(0, image.rows - size.height + 1));
    objectTexture(size, random).copyTo(result(cv::Rect(corner, size)));
  }
  return result;
}

cv::Mat rolled(const cv::Mat& image, double degrees) {
  const cv::Point2f centre(0.5F * static_cast<float>(image.cols - 1),
                           0.5F * static_cast<float>(image.rows - 1));
  cv::Mat result;
  cv::warpAffine(image, result, cv::getRotationMatrix2D(centre, degrees, 1.0), image.size(), cv::INTER_LINEAR,
                 cv::BORDER_REPLICATE);
  return result;
}

/// The camera looks up, so the scene moves down; what comes into view at the top is not known and shows
/// nothing.
cv::Mat pitched(const cv::Mat& image, double degrees) {
  const double down_px = kFocalShare * image.cols * std::tan(degrees * CV_PI / 180.0);
  const cv::Matx23d move(1.0, 0.0, 0.0, 0.0, 1.0, down_px);
  cv::Mat result;
  cv::warpAffine(image, result, move, image.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return result;
}

cv::Mat blurred(const cv::Mat& image, double length_px) {
  cv::Mat result;
  cv::blur(image, result, {std::max(1, static_cast<int>(std::lround(length_px))), 1});
  return result;
}

cv::Mat saturated(const cv::Mat& image, double share, cv::RNG& random) {
  const int columns = static_cast<int>(std::lround(share * image.cols));
  const int left = random.uniform(0, 2) == 0 ? 0 : image.cols - columns;
  cv::Mat result = image.clone();
  result.colRange(left, left + columns).setTo(255);
  return result;
}

}  // namespace

Disturbance Disturbance::parse(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  const std::string amount = equals == std::string::npos ? "" : text.substr(equals + 1);
  char* end = nullptr;
  const double value = std::strtod(amount.c_str(), &end);
  for (const KindName& known : kKinds) {
    if (name == known.name && !amount.empty() && *end == '\0' && value >= 0.0 && value <= known.largest) {
      return {known.kind, value};
    }
  }
  throw ParameterError(
      "'" + text +
      "' is no disturbance; those are cover=0..1, blur=PX, roll=DEGREES, pitch=DEGREES, saturate=0..1");
}

cv::Mat disturbed(const cv::Mat& image, const Disturbance& disturbance, std::uint64_t seed) {
  cv::RNG random(0x9E3779B97F4A7C15ULL * (seed + 1));
  random.next();
  switch (disturbance.kind) {
    case Disturbance::Kind::kCover:
      return covered(image, disturbance.amount, random);
    case Disturbance::Kind::kBlur:
      return blurred(image, disturbance.amount);
    case Disturbance::Kind::kRoll:
      return rolled(image, disturbance.amount);
    case Disturbance::Kind::kPitch:
      return pitched(image, disturbance.amount);
    case Disturbance::Kind::kSaturate:
      return saturated(image, disturbance.amount, random);
  }
  return image;
}

}  // namespace perennial
