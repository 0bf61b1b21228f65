#include "perennial/strategies/latest_map.h"

#include <numeric>
#include <vector>

#include "perennial/core/map_update.h"

namespace perennial::strategies {

void LatestMap::update(LocalMap& map, const Observation& observation) const {
  if (observation.view.empty()) {
    return;  // nothing is not a better map than something
  }
  std::vector<std::size_t> whole_view(observation.view.size());
  std::iota(whole_view.begin(), whole_view.end(), std::size_t{0});
  map.erase(std::vector<bool>(map.size(), true));
  insertFromView(map, observation, whole_view);
}

}  // namespace perennial::strategies
