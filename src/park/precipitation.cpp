#include "perennial/park/precipitation.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "perennial/park/lighting.h"
#include "perennial/park/random.h"

namespace perennial::park {
namespace {

constexpr double kBoxM = 12.0;  ///< side of the box that is filled with drops, and repeats
constexpr double kBoxHeightM = 6.0;
constexpr double kNearestM = 0.25;

struct Kind {
  int count;
  double fall_m_s, drift, diameter_m, opacity;
};

constexpr Kind kRain = {2500, 7.0, 0.35, 0.004, 0.5};
constexpr Kind kSnow = {3000, 1.1, 0.5, 0.008, 0.8};

double wrapped(double value, double length) { return value - length * std::floor(value / length); }

/// Turns the park's coordinates into the camera's pixels.
class Projector {
 public:
  Projector(const CameraPose& pose, const CameraGeometry& geometry)
      : pose_(pose), geometry_(geometry), c_(std::cos(pose.heading)), s_(std::sin(pose.heading)) {}

  struct Pixel {
    cv::Point2d at;
    double depth_m;
  };

  /// Nothing for what is behind or too near. Small tilts shift the picture.
  std::optional<Pixel> project(const cv::Point3d& from_camera) const {
    const double depth = c_ * from_camera.x + s_ * from_camera.y;
    if (depth < kNearestM) {
      return std::nullopt;
    }
    const double left = -s_ * from_camera.x + c_ * from_camera.y;
    return Pixel{{geometry_.cx - geometry_.fx * left / depth,
                  geometry_.cy - geometry_.fy * (from_camera.z / depth - pose_.pitch)},
                 depth};
  }

 private:
  CameraPose pose_;
  CameraGeometry geometry_;
  double c_, s_;
};

/// Mixes a spot or streak into the picture.
void blend(cv::Mat& picture, const cv::Point2d& from, const cv::Point2d& to, double width_px, double opacity,
           const cv::Scalar& colour) {
  constexpr int kMargin = 2;
  const int reach = static_cast<int>(std::ceil(width_px)) + kMargin;
  const cv::Point low(static_cast<int>(std::min(from.x, to.x)) - reach,
                      static_cast<int>(std::min(from.y, to.y)) - reach);
  const cv::Point high(static_cast<int>(std::max(from.x, to.x)) + reach,
                       static_cast<int>(std::max(from.y, to.y)) + reach);
  const cv::Rect box = cv::Rect(low, high) & cv::Rect(0, 0, picture.cols, picture.rows);
  if (box.empty()) {
    return;
  }
  cv::Mat region = picture(box);
  cv::Mat drawn = region.clone();
  const auto fixed = [&](const cv::Point2d& point) {
    return cv::Point(static_cast<int>(std::lround((point.x - box.x) * 16.0)),
                     static_cast<int>(std::lround((point.y - box.y) * 16.0)));
  };
  cv::line(drawn, fixed(from), fixed(to), colour, std::max(1, static_cast<int>(std::lround(width_px))),
           cv::LINE_AA, 4);
  cv::addWeighted(drawn, opacity, region, 1.0 - opacity, 0.0, region);
}

/// Light that a drop throws at the camera, as the renderer writes it.
cv::Scalar dropColour(const Lighting& light, double depth_m, double exposure) {
  const double lamp = 0.25 * light.searchlight / std::max(depth_m * depth_m, 0.3);
  const auto encode = [&](double radiance) {
    return 255.0 * std::sqrt(std::min(1.0, (radiance + lamp) * exposure / Renderer::kEncodedWhite));
  };
  return {encode(light.horizon[2]), encode(light.horizon[1]), encode(light.horizon[0]),
          encode(light.horizon[1])};
}

}  // namespace

void drawPrecipitation(cv::Mat& rendered, const Conditions& conditions, const CameraPose& pose,
                       const CameraGeometry& geometry, double exposure_s, double exposure) {
  if (conditions.weather != Weather::kRain && conditions.weather != Weather::kSnow) {
    return;
  }
  const Kind& kind = conditions.weather == Weather::kRain ? kRain : kSnow;
  const Lighting light = lightingOf(conditions);
  const Projector projector(pose, geometry);
  const double time_s = std::fmod(conditions.date_time_s, 3600.0);
  const double drift = kind.drift * conditions.wind_m_s;
  Random random(mix({conditions.world_seed, conditions.day(), 66}));
  for (int i = 0; i < kind.count; ++i) {
    const double x = random.uniform(0.0, kBoxM), y = random.uniform(0.0, kBoxM),
                 z = random.uniform(0.0, kBoxHeightM);
    const double fall = kind.fall_m_s * random.uniform(0.8, 1.2);
    const cv::Point3d at(wrapped(x + drift * time_s - pose.x, kBoxM) - kBoxM / 2.0,
                         wrapped(y + 0.6 * drift * time_s - pose.y, kBoxM) - kBoxM / 2.0,
                         wrapped(z - fall * time_s - pose.z, kBoxHeightM) - pose.z);
    const auto start = projector.project(at);
    const auto end = projector.project(at + cv::Point3d(drift, 0.6 * drift, -fall) * exposure_s);
    if (start && end && start->at.x > -20.0 && start->at.x < geometry.width + 20.0) {
      const double width = kind.diameter_m * geometry.fx / start->depth_m;
      const double length = cv::norm(end->at - start->at);
      // What is smaller than a pixel, or moves by more than its own size, covers pixels in part.
      const double opacity =
          kind.opacity * std::min(1.0, width) * std::max(0.25, std::min(1.0, 2.0 * width / (length + width)));
      blend(rendered, start->at, end->at, width, opacity, dropColour(light, start->depth_m, exposure));
    }
  }
}

}  // namespace perennial::park
