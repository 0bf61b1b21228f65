#include "perennial/strategies/strict_map.h"

namespace perennial::strategies {

void StrictMap::update(LocalMap& map, const Observation& observation) const {
  exchangeFeatures(map, observation, featuresIn(observation, FeatureState::kMatchedIncorrectly),
                   newFeatures(map, observation, adding_), map.size());
}

}  // namespace perennial::strategies
