#include "perennial/core/local_map.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <unordered_set>

namespace perennial {
namespace {

bool allFinite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

}  // namespace

std::size_t LocalMap::add(const Keypoint& keypoint, const Descriptor& descriptor) {
  features.add(keypoint, descriptor);
  ids.push_back(next_id++);
  numbers.resize(numbers.size() + numbers_per_feature, 0.0);
  return size() - 1;
}

void LocalMap::erase(const std::vector<bool>& drop) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < size(); ++i) {
    if (drop[i]) {
      continue;
    }
    if (kept != i) {
      features.keypoints[kept] = features.keypoints[i];
      features.descriptors[kept] = features.descriptors[i];
      ids[kept] = ids[i];
      std::copy_n(featureNumbers(i), numbers_per_feature, featureNumbers(kept));
    }
    ++kept;
  }
  features.keypoints.resize(kept);
  features.descriptors.resize(kept);
  ids.resize(kept);
  numbers.resize(kept * numbers_per_feature);
}

bool LocalMap::adopt(const std::string& name, std::size_t new_numbers_per_feature) {
  if (strategy == name && numbers_per_feature == new_numbers_per_feature) {
    return false;
  }
  strategy = name;
  numbers_per_feature = new_numbers_per_feature;
  numbers.assign(size() * numbers_per_feature, 0.0);
  map_numbers.clear();
  return true;
}

std::string LocalMap::problem() const {
  const std::size_t n = features.keypoints.size();
  if (features.descriptors.size() != n || ids.size() != n || numbers.size() != n * numbers_per_feature) {
    return "the arrays of its features differ in length";
  }
  if (!std::isfinite(distance_m) || distance_m < 0.0 || !std::isfinite(stamp_s)) {
    return "its distance or stamp is not a valid number";
  }
  // Features are only ever added and erased, which leaves identities ascending, and so without repetition.
  const bool ascending = std::is_sorted(ids.begin(), ids.end(), std::less_equal<>());
  std::unordered_set<std::uint32_t> seen;
  for (std::size_t i = 0; i < n; ++i) {
    const Keypoint& keypoint = features.keypoints[i];
    if (!std::isfinite(keypoint.x) || !std::isfinite(keypoint.y) || !std::isfinite(keypoint.scale) ||
        !std::isfinite(keypoint.response)) {
      return "keypoint " + std::to_string(i) + " is not finite";
    }
    if (ids[i] >= next_id) {
      return "feature " + std::to_string(i) + " has an identity that was never given out";
    }
    if (!ascending && !seen.insert(ids[i]).second) {
      return "the identity of feature " + std::to_string(i) + " is used twice";
    }
  }
  if (!allFinite(numbers) || !allFinite(map_numbers)) {
    return "a number of its strategy is not finite";
  }
  return "";
}

}  // namespace perennial
