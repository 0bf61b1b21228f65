#include "perennial/core/learning.h"

#include <string>

#include "perennial/core/error.h"

namespace perennial {

void takeOver(LocalMap& map, const MapStrategy& strategy) {
  map.adopt(numbersOwner(strategy), strategy.numbersPerFeature());
}

bool teaches(const Observation& observation, const LearningGate& gate) {
  const RegistrationResult& registration = observation.registration;
  return registration.displacement_px.has_value() && registration.inliers >= gate.min_inliers &&
         registration.confidence >= gate.min_confidence;
}

void learn(LocalMap& map, const MapStrategy& strategy, const Observation& observation) {
  strategy.update(map, observation);
  const std::string problem = map.problem();
  if (!problem.empty()) {
    throw Error("strategy " + strategy.name() + " broke local map " + std::to_string(map.index) + ": " +
                problem);
  }
}

}  // namespace perennial
