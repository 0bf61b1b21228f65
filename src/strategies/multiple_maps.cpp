#include "perennial/strategies/multiple_maps.h"

#include <algorithm>
#include <numeric>

#include "perennial/core/map_update.h"

namespace perennial::strategies {
namespace {

std::size_t alternativeOf(const LocalMap& map, std::size_t feature) {
  return static_cast<std::size_t>(map.featureNumbers(feature)[0]);
}

/// Features of each alternative, which may be none.
Alternatives split(const LocalMap& map) {
  Alternatives result(1);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const std::size_t alternative = alternativeOf(map, i);
    if (alternative >= result.size()) {
      result.resize(alternative + 1);
    }
    result[alternative].push_back(i);
  }
  return result;
}

void remove(LocalMap& map, std::size_t alternative) {
  std::vector<bool> drop(map.size(), false);
  for (std::size_t i = 0; i < map.size(); ++i) {
    drop[i] = alternativeOf(map, i) == alternative;
  }
  map.erase(drop);
}

}  // namespace

void MultipleMaps::configure(ParameterReader& reader) {
  settings_.min_correct = reader.integer("min_correct", settings_.min_correct, 1, 1000000);
  settings_.max_alternatives = reader.integer("max_alternatives", settings_.max_alternatives, 1, 1000);
}

std::size_t MultipleMaps::maxFeatures(std::size_t taught, std::size_t seen) const {
  return taught + (static_cast<std::size_t>(settings_.max_alternatives) - 1) * seen;
}

Alternatives MultipleMaps::alternatives(const LocalMap& map, double /*stamp_s*/) const {
  Alternatives result = split(map);
  const auto empty = [](const std::vector<std::size_t>& used) { return used.empty(); };
  result.erase(std::remove_if(result.begin(), result.end(), empty), result.end());
  if (result.empty()) {
    result.emplace_back();  // of an empty map
  }
  return result;
}

void MultipleMaps::update(LocalMap& map, const Observation& observation) const {
  std::vector<double>& last_best_s = map.map_numbers;
  last_best_s.resize(std::max(last_best_s.size(), split(map).size()), map.stamp_s);
  if (!observation.used.empty() && observation.registration.inliers >= settings_.min_correct) {
    double& last = last_best_s[alternativeOf(map, observation.used.front())];
    last = std::max(last, observation.stamp_s);
    return;
  }
  if (observation.view.empty() || settings_.max_alternatives == 1) {
    return;
  }
  const std::size_t alternative = alternativeToReplace(last_best_s);
  last_best_s.resize(std::max(last_best_s.size(), alternative + 1));
  last_best_s[alternative] = observation.stamp_s;
  remove(map, alternative);
  const std::size_t first_new = map.size();
  std::vector<std::size_t> whole_view(observation.view.size());
  std::iota(whole_view.begin(), whole_view.end(), std::size_t{0});
  insertFromView(map, observation, whole_view);
  for (std::size_t i = first_new; i < map.size(); ++i) {
    map.featureNumbers(i)[0] = static_cast<double>(alternative);
  }
}

std::size_t MultipleMaps::alternativeToReplace(const std::vector<double>& last_best_s) const {
  if (last_best_s.size() < static_cast<std::size_t>(settings_.max_alternatives)) {
    return last_best_s.size();
  }
  const auto oldest = std::min_element(last_best_s.begin() + 1, last_best_s.end());
  return static_cast<std::size_t>(oldest - last_best_s.begin());
}

}  // namespace perennial::strategies
