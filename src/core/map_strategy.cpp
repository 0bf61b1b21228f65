#include "perennial/core/map_strategy.h"

#include <numeric>

namespace perennial {

Alternatives MapStrategy::alternatives(const LocalMap& map, double /*stamp_s*/) const {
  std::vector<std::size_t> all(map.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return {all};
}

std::string numbersOwner(const MapStrategy& strategy) {
  return strategy.name() + "/" + std::to_string(strategy.version());
}

}  // namespace perennial
