#pragma once

#include <deque>
#include <optional>
#include <string>

#include "perennial/core/parameter_reader.h"

namespace perennial {

/// Pose and velocity of the robot as its odometry reports them.
struct OdometrySample {
  double stamp_s = 0.0;  ///< seconds since 1970
  double x_m = 0.0;      ///< in the odometry's own frame
  double y_m = 0.0;
  double forward_m_s = 0.0;  ///< velocity in the robot's frame
  double angular_rad_s = 0.0;
};

struct OdometerSettings {
  double max_speed_m_s = 3.0;  ///< a sample that implies a higher speed is a jump; not of less than 0.1 m
  double history_s = 10.0;     ///< how far back distances can be asked for

  /// Keys as the members are called. Throws ParameterError.
  static OdometerSettings load(ParameterReader& reader);
};

/// Travelled distance from odometry: the sum of the lengths of its steps, backwards driving counted like
/// forwards. Not thread-safe.
class Odometer {
 public:
  explicit Odometer(const OdometerSettings& settings = {}) : settings_(settings) {}

  /// Takes a sample; returns an empty text, or why the sample was refused: not finite, stamped before the
  /// last one or a jump. A refused sample changes nothing. A repeated stamp is ignored.
  std::string add(const OdometrySample& sample);

  /// Travelled distance at this time, interpolated. None when it lies after the newest sample or before the
  /// history.
  std::optional<double> distanceAt(double stamp_s) const;

  /// The newest sample; none before the first.
  std::optional<OdometrySample> newest() const;
  double newestDistance() const { return track_.empty() ? 0.0 : track_.back().distance_m; }

  /// Forgets everything; the next sample starts at distance 0.
  void reset();

 private:
  struct TrackPoint {
    OdometrySample sample;
    double distance_m = 0.0;
  };

  OdometerSettings settings_;
  std::deque<TrackPoint> track_;
};

}  // namespace perennial
