#include "perennial/core/map_update.h"

#include <algorithm>

namespace perennial {
namespace {

int distanceToNearest(const Descriptor& descriptor, const std::vector<Descriptor>& others) {
  int nearest = Descriptor::kBits + 1;
  for (const Descriptor& other : others) {
    nearest = std::min(nearest, hammingDistance(descriptor, other));
  }
  return nearest;
}

}  // namespace

std::vector<std::size_t> newFeatures(const LocalMap& map, const Observation& observation) {
  const FeatureSet& view = observation.view;
  std::vector<bool> paired(view.size(), false);
  for (const std::int32_t partner : observation.registration.partners) {
    if (partner >= 0) {
      paired[static_cast<std::size_t>(partner)] = true;
    }
  }
  std::vector<std::size_t> candidates;
  std::vector<int> distance(view.size(), 0);
  for (std::size_t j = 0; j < view.size(); ++j) {
    if (!paired[j]) {
      candidates.push_back(j);
      distance[j] = distanceToNearest(view.descriptors[j], map.features.descriptors);
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [&](std::size_t a, std::size_t b) { return distance[a] > distance[b]; });
  return candidates;
}

void insertFromView(LocalMap& map, const Observation& observation, const std::vector<std::size_t>& view_indices) {
  const double displacement = observation.registration.displacement_px.value();
  for (const std::size_t j : view_indices) {
    Keypoint keypoint = observation.view.keypoints[j];
    keypoint.x = static_cast<float>(keypoint.x + displacement);
    map.add(keypoint, observation.view.descriptors[j]);
  }
}

}  // namespace perennial
