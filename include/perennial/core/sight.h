#pragma once

#include "perennial/core/registration.h"

namespace perennial {

/// What an image was worth for driving.
struct Sight {
  bool recognised = false;  ///< whether there is a displacement
  double confidence = 0.0;  ///< of it, 0 to 1
};

/// Confidence grows with the number of pairs that agree, from 0 with none to 1 with `kSureInliers` times the fewest that give a
/// displacement.
Sight sightOf(const RegistrationResult& result, int min_inliers);

}  // namespace perennial
