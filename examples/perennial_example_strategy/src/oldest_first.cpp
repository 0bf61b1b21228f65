#include "perennial_example_strategy/oldest_first.h"

#include <perennial/core/map_update.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <pluginlib/class_list_macros.hpp>
#include <vector>

namespace perennial_example_strategy {
namespace {

void rememberWhatWasSeen(perennial::LocalMap& map, const perennial::Observation& observation) {
  for (std::size_t k = 0; k < observation.used.size(); ++k) {
    if (observation.registration.states[k] == perennial::FeatureState::kMatchedCorrectly) {
      double& last_seen_s = map.featureNumbers(observation.used[k])[0];
      last_seen_s = std::max(last_seen_s, observation.stamp_s);
    }
  }
}

}  // namespace

void OldestFirst::configure(perennial::ParameterReader& reader) {
  exchange_ = reader.real("exchange", exchange_, 0.0, 1.0);
}

void OldestFirst::update(perennial::LocalMap& map, const perennial::Observation& observation) const {
  rememberWhatWasSeen(map, observation);

  // Never drop what cannot be replaced: as many as the view has new features, and no more than wanted.
  std::vector<std::size_t> incoming = perennial::newFeatures(map, observation);
  const auto wanted = static_cast<std::size_t>(std::lround(exchange_ * static_cast<double>(map.size())));
  incoming.resize(std::min(incoming.size(), wanted));

  std::vector<std::size_t> oldest_first(map.size());
  std::iota(oldest_first.begin(), oldest_first.end(), std::size_t{0});
  std::stable_sort(oldest_first.begin(), oldest_first.end(), [&](std::size_t a, std::size_t b) {
    return map.featureNumbers(a)[0] <
           map.featureNumbers(b)[0];  // equal: features stand in order of their coming
  });
  std::vector<bool> drop(map.size(), false);
  for (std::size_t k = 0; k < incoming.size(); ++k) {
    drop[oldest_first[k]] = true;
  }
  map.erase(drop);
  perennial::insertFromView(map, observation, incoming);
}

}  // namespace perennial_example_strategy

PLUGINLIB_EXPORT_CLASS(perennial_example_strategy::OldestFirst, perennial::MapStrategy)
