#pragma once

#include <optional>

#include "perennial/core/parameter_reader.h"

namespace perennial {

struct AlongPathSettings {
  bool enabled = true;
  double correction_length_m =
      1.0;                      ///< an error of the distance decays by 1/e while the robot travels so far
  double max_correction = 0.2;  ///< metres of correction per metre travelled, at most

  /// Keys as the members are called. Throws ParameterError.
  static AlongPathSettings load(ParameterReader& reader);
};

/// How many features agreed with the view at one place of the path.
struct PlaceEvidence {
  double distance_m = 0.0;
  int inliers = 0;
};

/// Where on the path the view was taken, from the inliers of the local map nearest to the odometry's distance
/// and its two neighbours: the vertex of the parabola through the three, at most one neighbour away. None
/// without a maximum. The views' likeness falls off along the path to both sides of where the robot is; the
/// same evidence is used by appearance-based along-path correction in Dall'Osto, Fischer and Milford, "Fast
/// and Robust Bio-inspired Teach and Repeat Navigation", IROS 2021, there by correlation of whole images.
std::optional<double> placeOfView(const PlaceEvidence& before, const PlaceEvidence& here,
                                  const PlaceEvidence& after);

/// Corrects the odometry's distance by what the robot sees, slowly and within bounds: an odometry that is
/// some percent wrong, or a curve driven beside the path, must not add up over the path. Not thread-safe.
class AlongPathCorrection {
 public:
  explicit AlongPathCorrection(const AlongPathSettings& settings = {}) : settings_(settings) {}

  void reset() { correction_m_ = 0.0; }

  /// `distance_m`: corrected so far; `seen_m`: where the view says it was taken; `travelled_m`: since the
  /// last call.
  void update(double distance_m, double seen_m, double travelled_m);

  /// To be added to the odometry's distance.
  double correction() const { return correction_m_; }
  bool enabled() const { return settings_.enabled; }

 private:
  AlongPathSettings settings_;
  double correction_m_ = 0.0;
};

}  // namespace perennial
