#include "perennial/strategies/summary_map.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace perennial::strategies {
namespace {

std::vector<std::size_t> dispensableFirst(const LocalMap& map) {
  std::vector<bool> proven(map.size());
  for (std::size_t i = 0; i < map.size(); ++i) {
    proven[i] = map.featureNumbers(i)[0] > 0.0;
  }
  return worstFirst(map, std::vector<double>(map.size(), 0.0), proven);
}

}  // namespace

void SummaryMap::configure(ParameterReader& reader) {
  settings_.share = reader.real("share", settings_.share, 0.0, 1.0);
  settings_.max_features = reader.integer("max_features", settings_.max_features, 1, 1000000);
  settings_.adding = AddSettings::load(reader);
}

std::size_t SummaryMap::maxFeatures(std::size_t taught, std::size_t /*seen*/) const {
  return std::max(taught, static_cast<std::size_t>(settings_.max_features));
}

void SummaryMap::update(LocalMap& map, const Observation& observation) const {
  for (const std::size_t i : featuresIn(observation, FeatureState::kMatchedCorrectly)) {
    map.featureNumbers(i)[0] += 1.0;
  }
  std::vector<std::size_t> incoming = newFeatures(map, observation, settings_.adding);
  const auto wanted =
      static_cast<std::size_t>(std::lround(settings_.share * static_cast<double>(observation.view.size())));
  incoming.resize(std::min(incoming.size(), wanted));

  std::vector<bool> drop(map.size(), false);
  for (const std::size_t i : featuresIn(observation, FeatureState::kMatchedIncorrectly)) {
    drop[i] = true;
  }
  map.erase(drop);
  exchangeFeatures(map, observation, dispensableFirst(map), incoming,
                   static_cast<std::size_t>(settings_.max_features));
}

}  // namespace perennial::strategies
