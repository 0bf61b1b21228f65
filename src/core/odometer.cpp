#include "perennial/core/odometer.h"

#include <algorithm>
#include <cmath>

namespace perennial {
namespace {

/// What a step may be longer than the highest speed allows: stamps are not exact, least of all of samples
/// that were stamped when they arrived, in a burst.
constexpr double kSlack_m = 0.1;
/// Steps shorter in time are judged as if they took this long: two samples stamped almost alike are not a
/// jump.
constexpr double kShortestStep_s = 0.02;

std::string seconds(double value) { return std::to_string(value) + " s"; }

}  // namespace

OdometerSettings OdometerSettings::load(ParameterReader& reader) {
  OdometerSettings settings;
  settings.max_speed_m_s = reader.real("max_speed_m_s", settings.max_speed_m_s, 0.1, 100.0);
  settings.history_s = reader.real("history_s", settings.history_s, 0.5, 600.0);
  return settings;
}

std::string Odometer::add(const OdometrySample& sample) {
  const bool finite = std::isfinite(sample.stamp_s) && std::isfinite(sample.x_m) &&
                      std::isfinite(sample.y_m) && std::isfinite(sample.forward_m_s) &&
                      std::isfinite(sample.angular_rad_s);
  if (!finite) {
    return "odometry holds a value that is not finite";
  }
  if (track_.empty()) {
    track_.push_back({sample, 0.0});
    return "";
  }
  const TrackPoint& last = track_.back();
  const double elapsed_s = sample.stamp_s - last.sample.stamp_s;
  if (elapsed_s < 0.0) {
    return "odometry goes back in time, from " + seconds(last.sample.stamp_s) + " to " +
           seconds(sample.stamp_s);
  }
  if (elapsed_s == 0.0) {
    return "";
  }
  const double step_m = std::hypot(sample.x_m - last.sample.x_m, sample.y_m - last.sample.y_m);
  if (step_m > settings_.max_speed_m_s * std::max(elapsed_s, kShortestStep_s) + kSlack_m) {
    return "odometry jumps by " + std::to_string(step_m) + " m in " + seconds(elapsed_s);
  }
  track_.push_back({sample, last.distance_m + step_m});
  while (track_.size() > 2 && track_[1].sample.stamp_s < sample.stamp_s - settings_.history_s) {
    track_.pop_front();
  }
  return "";
}

std::optional<double> Odometer::distanceAt(double stamp_s) const {
  if (track_.empty() ||
      !(stamp_s >= track_.front().sample.stamp_s && stamp_s <= track_.back().sample.stamp_s)) {
    return std::nullopt;
  }
  const auto after =
      std::lower_bound(track_.begin(), track_.end(), stamp_s,
                       [](const TrackPoint& point, double stamp) { return point.sample.stamp_s < stamp; });
  if (after->sample.stamp_s == stamp_s) {
    return after->distance_m;
  }
  const auto before = std::prev(after);
  const double share = (stamp_s - before->sample.stamp_s) / (after->sample.stamp_s - before->sample.stamp_s);
  return before->distance_m + share * (after->distance_m - before->distance_m);
}

std::optional<OdometrySample> Odometer::newest() const {
  return track_.empty() ? std::nullopt : std::optional<OdometrySample>(track_.back().sample);
}

void Odometer::reset() { track_.clear(); }

}  // namespace perennial
