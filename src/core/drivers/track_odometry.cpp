#include "perennial/core/drivers/track_odometry.h"

#include <algorithm>
#include <cmath>

namespace perennial {
namespace {

/// Readings are taken once per loop of the robot but may be delivered later than the next one: a step is
/// compared with what the robot can do in the time since the last one and this much.
constexpr double kBunchingSlack_s = 0.1;
/// Below this span of time a mean velocity says nothing.
constexpr double kShortestWindow_s = 0.02;
/// Variance of a velocity that no reading stands behind yet.
constexpr double kUnknownVariance = 1e3;

/// How far a counter went on, wrapping included.
double step_m(std::int32_t from_mm, std::int32_t to_mm) {
  const auto difference = static_cast<std::uint32_t>(to_mm) - static_cast<std::uint32_t>(from_mm);
  return static_cast<std::int32_t>(difference) / 1000.0;
}

/// sin(x) / x.
double sinc(double x) { return std::abs(x) < 1e-6 ? 1.0 - x * x / 6.0 : std::sin(x) / x; }

}  // namespace

TrackOdometrySettings TrackOdometrySettings::load(ParameterReader& reader) {
  TrackOdometrySettings settings;
  settings.track_distance_m = reader.real("track_distance_m", settings.track_distance_m, 0.05, 5.0);
  settings.max_track_speed_mps = reader.real("max_track_speed_mps", settings.max_track_speed_mps, 0.1, 20.0);
  settings.max_gap_s = reader.real("max_gap_s", settings.max_gap_s, 0.1, 60.0);
  settings.twist_window_s = reader.real("twist_window_s", settings.twist_window_s, 0.04, 2.0);
  settings.track_variance_per_m =
      reader.real("track_variance_per_m", settings.track_variance_per_m, 1e-9, 1.0);
  return settings;
}

TrackOdometry::TrackOdometry(const TrackOdometrySettings& settings) : settings_(settings) {
  state_.twist_covariance = cv::Matx22d(kUnknownVariance, 0.0, 0.0, kUnknownVariance);
}

bool TrackOdometry::update(std::int32_t left_mm, std::int32_t right_mm, double stamp_s) {
  const double stamp = window_.empty() ? stamp_s : std::max(stamp_s, window_.back().stamp_s);
  const double left = step_m(last_left_mm_, left_mm);
  const double right = step_m(last_right_mm_, right_mm);
  last_left_mm_ = left_mm;
  last_right_mm_ = right_mm;
  if (!has_baseline_) {
    takeBaseline(stamp);
    return false;
  }
  const double elapsed = stamp - window_.back().stamp_s;
  if (elapsed > settings_.max_gap_s) {
    restart(settings_.max_track_speed_mps * settings_.max_gap_s);
    takeBaseline(stamp);
    return false;
  }
  if (isJump(left, right, elapsed)) {
    ++jumps_;
    restart(settings_.max_track_speed_mps * (elapsed + kBunchingSlack_s));
    takeBaseline(stamp);
    return false;
  }
  advance(left, right);
  updateTwist(stamp);
  return true;
}

void TrackOdometry::restart(double unseen_m) {
  if (!has_baseline_) {
    return;
  }
  has_baseline_ = false;
  const double turned = unseen_m / settings_.track_distance_m;
  state_.pose_covariance += cv::Matx33d::diag({unseen_m * unseen_m, unseen_m * unseen_m, turned * turned});
  state_.forward_mps = 0.0;
  state_.angular_radps = 0.0;
}

bool TrackOdometry::isJump(double left_m, double right_m, double elapsed_s) const {
  const double longest = settings_.max_track_speed_mps * (elapsed_s + kBunchingSlack_s);
  return std::abs(left_m) > longest || std::abs(right_m) > longest;
}

void TrackOdometry::takeBaseline(double stamp_s) {
  has_baseline_ = true;
  window_.clear();
  window_.push_back({stamp_s, way_m_, state_.yaw_rad});
  state_.forward_mps = 0.0;
  state_.angular_radps = 0.0;
  state_.twist_covariance = cv::Matx22d(kUnknownVariance, 0.0, 0.0, kUnknownVariance);
}

void TrackOdometry::advance(double left_m, double right_m) {
  const double way = 0.5 * (left_m + right_m);
  const double turn = (right_m - left_m) / settings_.track_distance_m;
  const double middle_heading = state_.yaw_rad + 0.5 * turn;
  const double chord = way * sinc(0.5 * turn);
  propagateCovariance(left_m, right_m, middle_heading);
  state_.x_m += chord * std::cos(middle_heading);
  state_.y_m += chord * std::sin(middle_heading);
  state_.yaw_rad += turn;
  way_m_ += way;
}

void TrackOdometry::propagateCovariance(double left_m, double right_m, double middle_heading_rad) {
  const double base = settings_.track_distance_m;
  const double way = 0.5 * (left_m + right_m);
  const double c = std::cos(middle_heading_rad);
  const double s = std::sin(middle_heading_rad);
  const cv::Matx33d by_pose(1.0, 0.0, -way * s,  //
                            0.0, 1.0, way * c,   //
                            0.0, 0.0, 1.0);
  // Columns: by the right and by the left track.
  const double side = 0.5 * way / base;
  const cv::Matx<double, 3, 2> by_tracks(0.5 * c - side * s, 0.5 * c + side * s,  //
                                         0.5 * s + side * c, 0.5 * s - side * c,  //
                                         1.0 / base, -1.0 / base);
  const cv::Matx22d tracks(settings_.track_variance_per_m * std::abs(right_m), 0.0,  //
                           0.0, settings_.track_variance_per_m * std::abs(left_m));
  state_.pose_covariance =
      by_pose * state_.pose_covariance * by_pose.t() + by_tracks * tracks * by_tracks.t();
}

void TrackOdometry::updateTwist(double stamp_s) {
  window_.push_back({stamp_s, way_m_, state_.yaw_rad});
  while (window_.size() > 2 && stamp_s - window_[1].stamp_s >= settings_.twist_window_s) {
    window_.pop_front();
  }
  const Sample& first = window_.front();
  const double span = stamp_s - first.stamp_s;
  if (span < kShortestWindow_s) {
    return;
  }
  state_.forward_mps = (way_m_ - first.way_m) / span;
  state_.angular_radps = (state_.yaw_rad - first.heading_rad) / span;
  // The counters resolve a millimetre, so each end of the window is uncertain by 1/12 of its square.
  const double base = settings_.track_distance_m;
  const double slip = settings_.track_variance_per_m * std::max(std::abs(way_m_ - first.way_m), 1e-3);
  const double track = (slip + 2.0 * 1e-6 / 12.0) / (span * span);
  state_.twist_covariance = cv::Matx22d(0.5 * track, 0.0, 0.0, 2.0 * track / (base * base));
}

}  // namespace perennial
