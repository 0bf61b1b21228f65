#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "perennial/core/registration.h"

namespace perennial {

inline double horizontalDifference(const FeatureSet& map, const FeatureSet& view, std::size_t i,
                                   std::int32_t j) {
  return double{map.keypoints[i].x} - double{view.keypoints[static_cast<std::size_t>(j)].x};
}

/// Calls visit(i, difference) for every pair of a registration.
template <class Visit>
void forEachPair(const FeatureSet& map, const FeatureSet& view, const RegistrationResult& result,
                 Visit visit) {
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (result.partners[i] >= 0) {
      visit(i, horizontalDifference(map, view, i, result.partners[i]));
    }
  }
}

/// Counts the pairs into `result.matches` and `result.histogram`, and marks them as matched incorrectly; what
/// is right is known only afterwards.
inline void countPairs(const FeatureSet& map, const FeatureSet& view, double bin_width_px,
                       RegistrationResult& result) {
  double largest = 0.0;
  result.matches = 0;
  result.states.assign(map.size(), FeatureState::kNotMatched);
  forEachPair(map, view, result, [&](std::size_t i, double difference) {
    largest = std::max(largest, std::abs(difference));
    result.states[i] = FeatureState::kMatchedIncorrectly;
    ++result.matches;
  });
  // std::lround rounds halves away from zero on both sides: bins symmetric about 0.
  const auto half = std::lround(largest / bin_width_px);
  result.histogram.bin_width_px = bin_width_px;
  result.histogram.counts.assign(static_cast<std::size_t>(2 * half + 1), 0);
  forEachPair(map, view, result, [&](std::size_t /*i*/, double difference) {
    ++result.histogram.counts[static_cast<std::size_t>(std::lround(difference / bin_width_px) + half)];
  });
}

}  // namespace perennial
