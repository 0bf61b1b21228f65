#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "perennial/core/feature.h"
#include "perennial/core/local_map.h"
#include "perennial/core/map_strategy.h"

/// A local map and observations of it made by hand, for tests that say exactly what a strategy must do.
namespace perennial {

/// Descriptor number `seed`; any two differ in about half of their bits.
inline Descriptor descriptorNumber(unsigned seed) {
  std::mt19937 random(seed);
  Descriptor descriptor;
  for (auto& word : descriptor.words) {
    word = (std::uint64_t{random()} << 32) | random();
  }
  return descriptor;
}

/// A map of n features at x = 100, 101, ..., taken over by the strategy. Feature i has identity i.
inline LocalMap mapFor(const MapStrategy& strategy, std::size_t n) {
  LocalMap map;
  for (std::size_t i = 0; i < n; ++i) {
    map.add({static_cast<float>(100 + i), 50.0F, 2.0F, 0.1F}, descriptorNumber(static_cast<unsigned>(i)));
  }
  map.adopt(numbersOwner(strategy), strategy.numbersPerFeature());
  return map;
}

constexpr char kCorrect = '+';
constexpr char kIncorrect = '-';
constexpr char kUnmatched = '.';

/// An observation of the features `used`, whose outcomes are given one character each: + correct, -
/// incorrect, . not matched. The view holds a partner for every matched one and `fresh` features like nothing
/// in the map, after them; fresh feature k is descriptor number 1000 * tag + k. Displacement: 10 px.
inline Observation observed(const LocalMap& map, const std::vector<std::size_t>& used,
                            const std::string& outcomes, std::size_t fresh, unsigned tag = 1,
                            double stamp_s = 1000.0) {
  Observation observation;
  observation.used = used;
  observation.stamp_s = stamp_s;
  observation.registration.displacement_px = 10.0;
  for (std::size_t k = 0; k < used.size(); ++k) {
    const FeatureState state = outcomes.at(k) == kCorrect     ? FeatureState::kMatchedCorrectly
                               : outcomes.at(k) == kIncorrect ? FeatureState::kMatchedIncorrectly
                                                              : FeatureState::kNotMatched;
    const bool paired = state != FeatureState::kNotMatched;
    observation.registration.states.push_back(state);
    observation.registration.partners.push_back(paired ? static_cast<std::int32_t>(observation.view.size())
                                                       : -1);
    observation.registration.inliers += state == FeatureState::kMatchedCorrectly ? 1 : 0;
    observation.registration.matches += paired ? 1 : 0;
    if (paired) {
      Keypoint keypoint = map.features.keypoints[used[k]];
      keypoint.x -= state == FeatureState::kMatchedCorrectly ? 10.0F : 300.0F;
      observation.view.add(keypoint, map.features.descriptors[used[k]]);
    }
  }
  for (std::size_t k = 0; k < fresh; ++k) {
    observation.view.add({static_cast<float>(400 + k), 80.0F, 2.0F, 0.1F},
                         descriptorNumber(1000 * tag + static_cast<unsigned>(k)));
  }
  return observation;
}

/// The same with all features of the map used.
inline Observation observed(const LocalMap& map, const std::string& outcomes, std::size_t fresh,
                            unsigned tag = 1, double stamp_s = 1000.0) {
  std::vector<std::size_t> all(map.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i] = i;
  }
  return observed(map, all, outcomes, fresh, tag, stamp_s);
}

using Ids = std::vector<std::uint32_t>;

}  // namespace perennial
