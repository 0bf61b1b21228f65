// Registration by voting: Halodova et al., "Predictive and adaptive maps for long-term visual navigation in
// changing environments", IROS 2019, section III.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include "core/registration/confidence.h"
#include "core/registration/displacement_histogram.h"
#include "core/registration/workspace.h"
#include "core/simd/kernels.h"
#include "perennial/core/registration.h"

namespace perennial {
namespace {

/// Index of the nearest descriptor if it passes the ratio test against all others, otherwise -1; of equally
/// near ones the first.
std::int32_t findPartner(const std::vector<std::uint16_t>& distances, double ratio) {
  const SmallestTwo smallest = kernels().smallest_two(distances.data(), distances.size());
  const bool unambiguous = distances.size() > 1 && smallest.first < ratio * smallest.second;
  if (!unambiguous) {
    return -1;
  }
  return static_cast<std::int32_t>(std::find(distances.begin(), distances.end(), smallest.first) -
                                   distances.begin());
}

void findPairs(const FeatureSet& map, const FeatureSet& view, const RegistrationSettings& settings,
               RegistrationWorkspace::Buffers& buffers, std::vector<std::int32_t>& partners) {
  buffers.view.resize(view.size());
  for (std::size_t j = 0; j < view.size(); ++j) {
    buffers.view.set(j, view.descriptors[j]);
  }
  buffers.distances.resize(view.size());
  partners.assign(map.size(), -1);
  const auto hamming_distances = kernels().hamming_distances;
  for (std::size_t i = 0; i < map.size(); ++i) {
    hamming_distances(map.descriptors[i], buffers.view, 0, view.size(), buffers.distances.data());
    const std::int32_t j = findPartner(buffers.distances, settings.ratio);
    if (j < 0) {
      continue;
    }
    const double vertical =
        double{map.keypoints[i].y} - double{view.keypoints[static_cast<std::size_t>(j)].y};
    if (std::abs(vertical) <= settings.max_vertical_px) {
      partners[i] = j;
    }
  }
}

std::size_t fullestBin(const DisplacementHistogram& histogram) {
  const auto count = [&](int position) {
    const bool inside = position >= 0 && position < static_cast<int>(histogram.counts.size());
    return inside ? histogram.counts[static_cast<std::size_t>(position)] : 0;
  };
  const auto rank = [&](int position) {
    const int bin = position - histogram.half();
    return std::make_tuple(count(position), count(position - 1) + count(position + 1), -std::abs(bin), bin);
  };
  int best = 0;
  for (int position = 1; position < static_cast<int>(histogram.counts.size()); ++position) {
    if (rank(position) > rank(best)) {
      best = position;
    }
  }
  return static_cast<std::size_t>(best);
}

}  // namespace

void HistogramRegistration::registerInto(const FeatureSet& map, const FeatureSet& view,
                                         RegistrationWorkspace& workspace, RegistrationResult& result) const {
  const double bin_width_px = settings().bin_width_px;
  findPairs(map, view, settings(), workspace.buffers(), result.partners);
  countPairs(map, view, bin_width_px, result);
  result.displacement_px.reset();
  result.inliers = 0;
  result.confidence = 0.0;
  result.uncertainty_px = 0.0;
  if (result.matches == 0) {
    return;
  }

  const double centre = result.histogram.centre(fullestBin(result.histogram));
  const auto agrees = [&](double difference) { return std::abs(difference - centre) <= 1.5 * bin_width_px; };
  double sum = 0.0;
  forEachPair(map, view, result, [&](std::size_t /*i*/, double difference) {
    if (agrees(difference)) {
      sum += difference;
      ++result.inliers;
    }
  });
  const double mean = sum / result.inliers;
  double squares = 0.0;
  forEachPair(map, view, result, [&](std::size_t /*i*/, double difference) {
    squares += agrees(difference) ? (difference - mean) * (difference - mean) : 0.0;
  });
  result.uncertainty_px = std::sqrt(squares / result.inliers);
  result.confidence = histogramConfidence(result.inliers);
  if (result.inliers < settings().min_inliers || result.confidence < settings().min_confidence) {
    return;
  }
  result.displacement_px = mean;
  forEachPair(map, view, result, [&](std::size_t i, double difference) {
    if (agrees(difference)) {
      result.states[i] = FeatureState::kMatchedCorrectly;
    }
  });
}

}  // namespace perennial
