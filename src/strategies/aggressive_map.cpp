#include "perennial/strategies/aggressive_map.h"

#include <vector>

namespace perennial::strategies {

void AggressiveMap::update(LocalMap& map, const Observation& observation) const {
  std::vector<std::size_t> drop = featuresIn(observation, FeatureState::kMatchedIncorrectly);
  const std::vector<std::size_t> unmatched = featuresIn(observation, FeatureState::kNotMatched);
  drop.insert(drop.end(), unmatched.begin(), unmatched.end());
  exchangeFeatures(map, observation, drop, newFeatures(map, observation, adding_), map.size());
}

}  // namespace perennial::strategies
