#pragma once

#include "perennial/core/registration.h"

namespace perennial {

/// What an image was worth for driving.
struct Sight {
  bool recognised = false;  ///< whether there is a displacement
  double confidence = 0.0;  ///< probability that it is right, 0 to 1
};

inline Sight sightOf(const RegistrationResult& result) {
  return {result.displacement_px.has_value(), result.confidence};
}

}  // namespace perennial
