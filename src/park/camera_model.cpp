#include "perennial/park/camera_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "perennial/core/error.h"

namespace perennial::park {
namespace {

constexpr double kRadPerDeg = 3.14159265358979323846 / 180.0;
constexpr double kGamma = 2.2;
constexpr double kReferenceTimeMs =
    0.4;  ///< at this time and gain 1 a radiance of 1 (white in the sun) saturates
constexpr int kBankSize = 1 << 20;

/// Light (1 saturates) of each value that the renderer writes.
const cv::Mat& decodeTable() {
  static const cv::Mat table = [] {
    cv::Mat values(1, 256, CV_32F);
    for (int i = 0; i < 256; ++i) {
      values.at<float>(i) = static_cast<float>(Renderer::kEncodedWhite * (i / 255.0) * (i / 255.0));
    }
    return values;
  }();
  return table;
}

/// The camera's tone curve: 8 bits of light in steps of 1 / 4095.
const std::array<unsigned char, 4096>& toneCurve() {
  static const std::array<unsigned char, 4096> curve = [] {
    std::array<unsigned char, 4096> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = static_cast<unsigned char>(
          std::lround(255.0 * std::pow(static_cast<double>(i) / 4095.0, 1.0 / kGamma)));
    }
    return values;
  }();
  return curve;
}

cv::Mat toned(const cv::Mat& light) {
  cv::Mat image(light.size(), CV_MAKETYPE(CV_8U, light.channels()));
  const auto& curve = toneCurve();
  const int values = light.cols * light.channels();
  for (int row = 0; row < light.rows; ++row) {
    const float* from = light.ptr<float>(row);
    unsigned char* to = image.ptr<unsigned char>(row);
    for (int i = 0; i < values; ++i) {
      to[i] = curve[static_cast<std::size_t>(std::clamp(from[i], 0.0F, 1.0F) * 4095.0F + 0.5F)];
    }
  }
  return image;
}

/// Mean along a horizontal line of this length, px; fractions of a pixel count.
void blurHorizontally(cv::Mat& light, double length_px) {
  const int reach = static_cast<int>(std::ceil((length_px - 1.0) / 2.0));
  if (reach < 1) {
    return;
  }
  cv::Mat kernel(1, 2 * reach + 1, CV_32F, cv::Scalar(1.0));
  const auto edge = static_cast<float>((length_px - (2.0 * reach - 1.0)) / 2.0);
  kernel.at<float>(0) = kernel.at<float>(2 * reach) = edge;
  cv::filter2D(light, light, CV_32F, kernel / cv::sum(kernel)[0], cv::Point(-1, -1), 0.0,
               cv::BORDER_REPLICATE);
}

}  // namespace

CameraSettings CameraSettings::load(ParameterReader& reader) {
  CameraSettings s;
  CameraGeometry& g = s.geometry;
  g.width = reader.integer("width", g.width, 64, 2048);
  g.height = reader.integer("height", g.height, 48, 2048);
  const double fov = reader.real("horizontal_fov_deg", 66.0, 20.0, 120.0);
  g.fx = g.fy = 0.5 * g.width / std::tan(0.5 * fov * kRadPerDeg);
  g.cx = 0.5 * (g.width - 1);
  g.cy = 0.5 * (g.height - 1);
  s.height_m = reader.real("camera_height_m", s.height_m, 0.1, 3.0);
  s.forward_m = reader.real("camera_forward_m", s.forward_m, -1.0, 1.0);
  s.exposure_max_ms = reader.real("exposure_max_ms", s.exposure_max_ms, 0.1, 60.0);
  s.exposure_min_ms = reader.real("exposure_min_ms", s.exposure_min_ms, 0.001, 0.1);
  s.gain_max_db = reader.real("gain_max_db", s.gain_max_db, 0.0, 60.0);
  s.target_brightness = reader.real("target_brightness", s.target_brightness, 0.05, 0.9);
  s.adaptation = reader.real("adaptation", s.adaptation, 0.01, 1.0);
  s.noise = reader.real("noise", s.noise, 0.0, 10.0);
  s.motion_blur = reader.real("motion_blur", s.motion_blur, 0.0, 10.0);
  s.jolt_deg = reader.real("jolt_deg", s.jolt_deg, 0.0, 5.0);
  return s;
}

CameraModel::CameraModel(const CameraSettings& settings, std::uint64_t seed)
    : settings_(settings), seed_(seed), noise_bank_(1, kBankSize, CV_32F) {
  cv::RNG generator(mix({static_cast<std::int64_t>(seed), 91}));
  generator.fill(noise_bank_, cv::RNG::NORMAL, 0.0, 1.0);
}

double CameraModel::exposure() const { return state_.time_ms * state_.gain / kReferenceTimeMs; }

cv::Mat CameraModel::develop(const cv::Mat& rendered, double turn_rate, std::int64_t number, bool colour) {
  cv::Mat encoded;
  if (colour) {
    cv::cvtColor(rendered, encoded, cv::COLOR_BGRA2BGR);
  } else {
    cv::extractChannel(rendered, encoded, 3);
  }
  cv::Mat light;
  cv::LUT(encoded, decodeTable(), light);
  blurHorizontally(light, blurLength(turn_rate));
  addNoise(light, number);
  cv::Mat image = toned(light);
  adapt(image);
  return image;
}

double CameraModel::blurLength(double turn_rate) const {
  return settings_.motion_blur * std::abs(turn_rate) * settings_.geometry.fx * state_.time_ms * 1e-3;
}

/// Shot noise of the photons, which are fewer the higher the gain, and read noise, which the gain amplifies.
void CameraModel::addNoise(cv::Mat& light, std::int64_t number) const {
  constexpr float kShotAtWhite = 0.010F;  // a full well of 10 000 electrons
  constexpr float kRead = 0.0012F;
  if (settings_.noise == 0.0) {
    return;
  }
  const auto gain = static_cast<float>(state_.gain);
  const auto amount = static_cast<float>(settings_.noise);
  const float shot2 = kShotAtWhite * kShotAtWhite * gain * amount * amount;
  const float read2 = kRead * kRead * gain * gain * amount * amount;
  const int values = light.cols * light.channels();
  Random random(mix({static_cast<std::int64_t>(seed_), number, 92}));
  for (int row = 0; row < light.rows; ++row) {
    float* pixel = light.ptr<float>(row);
    const float* normal = noise_bank_.ptr<float>() + random.below(kBankSize - values);
    for (int i = 0; i < values; ++i) {
      pixel[i] += std::sqrt(shot2 * pixel[i] + read2) * normal[i];
    }
  }
}

/// Aims at a mean brightness of the lower two thirds: the sky would darken the rest.
void CameraModel::adapt(const cv::Mat& image) {
  const cv::Rect metered(0, image.rows / 3, image.cols, image.rows - image.rows / 3);
  const cv::Scalar sums = cv::mean(image(metered));
  const double mean = image.channels() == 3 ? (sums[0] + sums[1] + sums[2]) / 3.0 : sums[0];
  const double ratio = settings_.target_brightness / std::max(mean / 255.0, 0.02);
  const double wanted = state_.time_ms * state_.gain * std::pow(ratio, kGamma * settings_.adaptation);
  const double gain_max = std::pow(10.0, settings_.gain_max_db / 20.0);
  const double product = std::clamp(wanted, settings_.exposure_min_ms, settings_.exposure_max_ms * gain_max);
  state_.settled = std::abs(std::log(ratio)) < 0.05 || product != wanted;
  state_.time_ms = std::min(product, settings_.exposure_max_ms);
  state_.gain = product / state_.time_ms;
}

}  // namespace perennial::park
