#pragma once

#include <string>

#include "perennial/core/map_strategy.h"

namespace perennial::strategies {

/// "latest": the map is what was seen last. Drops everything and takes over the whole view, in the map's
/// frame. Adapts fastest, and drifts: every traversal's error is added to the next one's map.
class LatestMap : public MapStrategy {
 public:
  std::string name() const override { return "latest"; }
  void update(LocalMap& map, const Observation& observation) const override;
};

}  // namespace perennial::strategies
