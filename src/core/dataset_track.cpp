#include "perennial/core/dataset_track.h"

#include <algorithm>
#include <cmath>

#include "perennial/core/error.h"

namespace perennial {
namespace {

constexpr double kSlowest_m_s = 0.01;
constexpr double kSpacing_m = 0.05;

bool drivable(const std::vector<DatasetRow>& rows) {
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double elapsed_s = rows[i].stamp_s - rows[i - 1].stamp_s;
    const double driven_m = rows[i].distance_m - rows[i - 1].distance_m;
    if (elapsed_s <= 0.0 || driven_m < kSlowest_m_s * elapsed_s) {
      return false;
    }
  }
  return true;
}

/// From just after `from` up to and including `to`.
void drive(const OdometrySample& from, const OdometrySample& to, std::vector<OdometrySample>& odometry) {
  const double elapsed_s = to.stamp_s - from.stamp_s;
  const double driven_m = to.x_m - from.x_m;
  const int steps = std::max(1, static_cast<int>(std::ceil(driven_m / kSpacing_m)));
  for (int k = 1; k < steps; ++k) {
    const double share = static_cast<double>(k) / steps;
    OdometrySample sample = to;
    sample.stamp_s = from.stamp_s + share * elapsed_s;
    sample.x_m = from.x_m + share * driven_m;
    odometry.push_back(sample);
  }
  odometry.push_back(to);
}

}  // namespace

DatasetTrack trackOf(const std::vector<DatasetRow>& rows, double speed_m_s) {
  if (rows.empty()) {
    throw DatasetError("a traversal without images cannot be driven");
  }
  DatasetTrack track;
  track.stamps_replaced = !drivable(rows);
  for (const DatasetRow& row : rows) {
    track.image_stamps_s.push_back(
        track.stamps_replaced ? rows.front().stamp_s + (row.distance_m - rows.front().distance_m) / speed_m_s
                              : row.stamp_s);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    OdometrySample sample;
    sample.stamp_s = track.image_stamps_s[i];
    sample.x_m = rows[i].distance_m;
    if (i == 0) {
      track.odometry.push_back(sample);
      continue;
    }
    const OdometrySample from = track.odometry.back();
    sample.forward_m_s = (sample.x_m - from.x_m) / (sample.stamp_s - from.stamp_s);
    if (i == 1) {
      track.odometry.front().forward_m_s = sample.forward_m_s;
    }
    drive(from, sample, track.odometry);
  }
  return track;
}

}  // namespace perennial
