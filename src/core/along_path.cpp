#include "perennial/core/along_path.h"

#include <algorithm>
#include <cmath>

namespace perennial {

AlongPathSettings AlongPathSettings::load(ParameterReader& reader) {
  AlongPathSettings settings;
  settings.enabled = reader.boolean("enabled", settings.enabled);
  settings.correction_length_m =
      reader.real("correction_length_m", settings.correction_length_m, 0.05, 1000.0);
  settings.max_correction = reader.real("max_correction", settings.max_correction, 0.0, 0.9);
  return settings;
}

std::optional<double> placeOfView(const PlaceEvidence& before, const PlaceEvidence& here,
                                  const PlaceEvidence& after) {
  if (before.inliers > here.inliers && before.inliers >= after.inliers) {
    return before.distance_m;
  }
  if (after.inliers > here.inliers) {
    return after.distance_m;
  }
  // Newton's divided differences of the parabola through the three.
  const double slope_before = (here.inliers - before.inliers) / (here.distance_m - before.distance_m);
  const double slope_after = (after.inliers - here.inliers) / (after.distance_m - here.distance_m);
  const double curvature = (slope_after - slope_before) / (after.distance_m - before.distance_m);
  if (!(curvature < 0.0)) {
    return std::nullopt;
  }
  const double vertex = (before.distance_m + here.distance_m) / 2.0 - slope_before / (2.0 * curvature);
  return std::clamp(vertex, before.distance_m, after.distance_m);
}

void AlongPathCorrection::update(double distance_m, double seen_m, double travelled_m) {
  if (!settings_.enabled || !(travelled_m > 0.0)) {
    return;
  }
  const double share = 1.0 - std::exp(-travelled_m / settings_.correction_length_m);
  const double bound_m = settings_.max_correction * travelled_m;
  correction_m_ += std::clamp(share * (seen_m - distance_m), -bound_m, bound_m);
}

}  // namespace perennial
