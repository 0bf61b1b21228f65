// Registration by voting: Halodova et al., "Predictive and adaptive maps for long-term visual navigation in changing
// environments", IROS 2019, section III.
#include "perennial/core/registration.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

#include "perennial/core/popcount_clones.h"

namespace perennial {
namespace {

/// Index of the view feature that passes the ratio test against all others, or -1.
PERENNIAL_POPCOUNT_CLONES
std::int32_t findPartner(const Descriptor& descriptor, const std::vector<Descriptor>& view, double ratio) {
  int nearest = Descriptor::kBits + 1;
  int second = Descriptor::kBits + 1;
  std::int32_t partner = -1;
  for (std::size_t j = 0; j < view.size(); ++j) {
    const int distance = hammingDistance(descriptor, view[j]);
    if (distance < nearest) {
      second = nearest;
      nearest = distance;
      partner = static_cast<std::int32_t>(j);
    } else if (distance < second) {
      second = distance;
    }
  }
  const bool unambiguous = view.size() > 1 && nearest < ratio * second;
  return unambiguous ? partner : -1;
}

std::vector<std::int32_t> findPairs(const FeatureSet& map, const FeatureSet& view,
                                    const RegistrationSettings& settings) {
  std::vector<std::int32_t> partners(map.size(), -1);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const std::int32_t j = findPartner(map.descriptors[i], view.descriptors, settings.ratio);
    if (j < 0) {
      continue;
    }
    const double vertical = double{map.keypoints[i].y} - double{view.keypoints[static_cast<std::size_t>(j)].y};
    if (std::abs(vertical) <= settings.max_vertical_px) {
      partners[i] = j;
    }
  }
  return partners;
}

double horizontalDifference(const FeatureSet& map, const FeatureSet& view, std::size_t i, std::int32_t j) {
  return double{map.keypoints[i].x} - double{view.keypoints[static_cast<std::size_t>(j)].x};
}

DisplacementHistogram vote(const std::vector<double>& differences, double bin_width_px) {
  double largest = 0.0;
  for (const double difference : differences) {
    largest = std::max(largest, std::abs(difference));
  }
  // std::lround rounds halves away from zero on both sides: bins symmetric about 0.
  const auto half = std::lround(largest / bin_width_px);
  DisplacementHistogram histogram{bin_width_px, std::vector<int>(static_cast<std::size_t>(2 * half + 1), 0)};
  for (const double difference : differences) {
    ++histogram.counts[static_cast<std::size_t>(std::lround(difference / bin_width_px) + half)];
  }
  return histogram;
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

RegistrationSettings RegistrationSettings::load(ParameterReader& reader) {
  RegistrationSettings settings;
  settings.ratio = reader.real("ratio", settings.ratio, 0.0, 1.0);
  settings.max_vertical_px = reader.real("max_vertical_px", settings.max_vertical_px, 0.0, 10000.0);
  settings.bin_width_px = reader.real("bin_width_px", settings.bin_width_px, 0.1, 1000.0);
  settings.min_inliers = reader.integer("min_inliers", settings.min_inliers, 1, 10000);
  return settings;
}

RegistrationResult HistogramRegistration::registerView(const FeatureSet& map, const FeatureSet& view) const {
  RegistrationResult result;
  result.partners = findPairs(map, view, settings_);
  result.states.assign(map.size(), FeatureState::kNotMatched);

  std::vector<double> differences;
  std::vector<std::size_t> paired;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (result.partners[i] >= 0) {
      paired.push_back(i);
      differences.push_back(horizontalDifference(map, view, i, result.partners[i]));
      result.states[i] = FeatureState::kMatchedIncorrectly;
    }
  }
  result.matches = static_cast<int>(differences.size());
  result.histogram = vote(differences, settings_.bin_width_px);
  if (differences.empty()) {
    return result;
  }

  const double centre = result.histogram.centre(fullestBin(result.histogram));
  const double reach = 1.5 * settings_.bin_width_px;
  const auto agrees = [&](double difference) { return std::abs(difference - centre) <= reach; };
  double sum = 0.0;
  for (const double difference : differences) {
    if (agrees(difference)) {
      sum += difference;
      ++result.inliers;
    }
  }
  if (result.inliers < settings_.min_inliers) {
    return result;
  }
  result.displacement_px = sum / result.inliers;
  for (std::size_t k = 0; k < paired.size(); ++k) {
    if (agrees(differences[k])) {
      result.states[paired[k]] = FeatureState::kMatchedCorrectly;
    }
  }
  return result;
}

}  // namespace perennial
