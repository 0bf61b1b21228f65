#pragma once

#include "perennial/core/local_map.h"
#include "perennial/core/map_strategy.h"

/// How a local map learns under a strategy, on the robot and in every replay alike.
namespace perennial {

/// Makes the map's numbers the strategy's: those of another strategy or version give way to zeros.
void takeOver(LocalMap& map, const MapStrategy& strategy);

/// What a registration must have reached to teach anything.
struct LearningGate {
  int min_inliers = 5;
  double min_confidence = 0.0;
};

/// Whether an observation may teach anything: its registration found a displacement and passes the gate.
bool teaches(const Observation& observation, const LearningGate& gate);

/// The strategy learns from the observation. Throws Error when it breaks the map, see LocalMap::problem().
void learn(LocalMap& map, const MapStrategy& strategy, const Observation& observation);

}  // namespace perennial
