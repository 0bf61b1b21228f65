#pragma once

#include <cstdint>
#include <deque>
#include <opencv2/core/matx.hpp>

#include "perennial/core/parameter_reader.h"

namespace perennial {

struct TrackOdometrySettings {
  double track_distance_m = 0.40;        ///< between the middles of the tracks
  double max_track_speed_mps = 2.0;      ///< no track is faster; a larger step is a jump of the counters
  double max_gap_s = 2.0;                ///< after a longer time without readings the counters are taken anew
  double twist_window_s = 0.15;          ///< velocities are means over this time
  double track_variance_per_m = 0.0004;  ///< variance of a track's length per metre that it ran, m^2/m

  /// Keys as the members are called. Throws ParameterError.
  static TrackOdometrySettings load(ParameterReader& reader);
};

/// Pose in the frame in which the odometry began (x forward, y left, yaw counter-clockwise, not wrapped) and
/// velocities of the body.
struct OdometryState {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double forward_mps = 0.0;
  double angular_radps = 0.0;
  cv::Matx33d pose_covariance = cv::Matx33d::zeros();   ///< of x, y, yaw
  cv::Matx22d twist_covariance = cv::Matx22d::zeros();  ///< of forward and angular velocity
};

/// Odometry of a tracked vehicle from the counters of its two tracks.
///
/// The pose follows the exact arc between two readings, and its covariance is propagated along it, with
/// variances of the tracks that grow with the way they ran (Siegwart and Nourbakhsh, "Introduction to
/// Autonomous Mobile Robots", section 5.2.4). The counters are millimetres in 32 bits: they wrap, and start
/// anew with the robot. A step that no robot can drive is such a new start: the counters are taken as the new
/// baseline, the pose stays. Not thread-safe.
class TrackOdometry {
 public:
  explicit TrackOdometry(const TrackOdometrySettings& settings);

  /// `stamp_s` is when the reading arrived, s. Readings may arrive late and in bunches. One that is older
  /// than the last one counts as simultaneous with it. Returns whether the pose followed; false for the first
  /// reading after a start, a gap or a jump.
  bool update(std::int32_t left_mm, std::int32_t right_mm, double stamp_s);

  /// The next reading is a new baseline: for a new connection to the robot. The robot may have rolled on in
  /// between; `unseen_m`, how far at most, goes into the covariance.
  void restart(double unseen_m);

  const OdometryState& state() const { return state_; }
  std::uint64_t jumps() const { return jumps_; }

 private:
  struct Sample {
    double stamp_s;
    double way_m;  ///< of the middle, since the baseline
    double heading_rad;
  };

  bool isJump(double left_m, double right_m, double elapsed_s) const;
  void takeBaseline(double stamp_s);
  void advance(double left_m, double right_m);
  void propagateCovariance(double left_m, double right_m, double middle_heading_rad);
  void updateTwist(double stamp_s);

  TrackOdometrySettings settings_;
  OdometryState state_;
  bool has_baseline_ = false;
  std::int32_t last_left_mm_ = 0;
  std::int32_t last_right_mm_ = 0;
  double way_m_ = 0.0;
  std::deque<Sample> window_;
  std::uint64_t jumps_ = 0;
};

}  // namespace perennial
