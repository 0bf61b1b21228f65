#pragma once

#include <string>

#include "perennial/core/map_strategy.h"

namespace perennial::strategies {

/// "static": the map stays as it was taught. The baseline of every comparison.
class StaticMap : public MapStrategy {
 public:
  std::string name() const override { return "static"; }
  void update(LocalMap& /*map*/, const Observation& /*observation*/) const override {}
};

}  // namespace perennial::strategies
