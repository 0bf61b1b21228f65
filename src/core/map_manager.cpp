#include "perennial/core/map_manager.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/features/edge_field_extractor.h"
#include "core/map/local_map_codec.h"
#include "perennial/core/error.h"
#include "perennial/core/learning.h"

namespace perennial {
namespace {

/// Observations of a local map are complete when the robot registers against one this many places further on:
/// distance estimates may waver between neighbours.
constexpr std::uint32_t kPlacesUntilLearned = 2;

/// Whether views of this map's features come with edges.
bool usesEdges(const MapMetadata& metadata) {
  return metadata.extraction.find(" descriptor=orientation") != std::string::npos;
}

}  // namespace

MapManagerSettings MapManagerSettings::load(ParameterReader& reader) {
  MapManagerSettings settings;
  settings.lookahead_m = reader.real("lookahead_m", settings.lookahead_m, 0.1, 1000.0);
  settings.lookbehind_m = reader.real("lookbehind_m", settings.lookbehind_m, 0.0, 1000.0);
  settings.gate.min_inliers = reader.integer("min_inliers_for_update", settings.gate.min_inliers, 1, 10000);
  settings.gate.min_confidence =
      reader.real("min_confidence_for_update", settings.gate.min_confidence, 0.0, 1.0);
  return settings;
}

MapManager::MapManager(MapFile file, std::shared_ptr<const MapStrategy> strategy,
                       const MapManagerSettings& settings)
    : file_(std::move(file)), strategy_(std::move(strategy)), settings_(settings) {}

void MapManager::beginTraversal(double stamp_s) {
  if (in_traversal_) {
    endTraversal(false, stamp_s);
  }
  cannot_learn_.clear();
  try {
    file_.beginTraversal(numbersOwner(*strategy_), stamp_s);
  } catch (const MigrationError& error) {
    cannot_learn_ = error.what();
  }
  in_traversal_ = true;
  stamp_s_ = stamp_s;
  handed_out_any_ = false;
  pending_.clear();
  learned_before_ = 0;
  updated_ = 0;
}

std::vector<std::uint32_t> MapManager::due(double distance_m) {
  const auto places = file_.between(distance_m - settings_.lookbehind_m, distance_m + settings_.lookahead_m);
  const std::uint32_t here = file_.nearest(distance_m).index;
  const auto last = static_cast<std::uint32_t>(file_.size()) - 1;
  std::uint32_t to = std::min(here + 2, last);
  std::uint32_t from = here == 0 ? 0 : here - 1;
  if (!places.empty()) {
    to = std::max(to, places.back().index);
    from = std::min(from, places.front().index);
  }
  if (handed_out_any_ && next_due_ >= from) {
    from = next_due_;
  }
  std::vector<std::uint32_t> indices;
  for (std::uint32_t index = from; index <= to; ++index) {
    indices.push_back(index);
  }
  if (!indices.empty()) {
    handed_out_any_ = true;
    next_due_ = to + 1;
  }
  return indices;
}

LocalMap MapManager::readForStrategy(std::uint32_t index) const {
  LocalMap map = file_.read(index);
  takeOver(map, *strategy_);
  return map;
}

ActiveMap MapManager::activeMap(std::uint32_t index) const {
  LocalMap map = readForStrategy(index);
  if (usesEdges(file_.metadata())) {
    map.features.edges = edgeFieldOf(file_.readImage(index));
  }
  return activate(*strategy_, map, stamp_s_);
}

ActiveMap MapManager::activeMapWithoutEdges(std::uint32_t index) const {
  return activate(*strategy_, readForStrategy(index), stamp_s_);
}

void MapManager::observe(std::uint32_t index, double local_map_distance_m, Observation observation) {
  if (!in_traversal_ || index >= file_.size()) {
    throw Error("an observation of local map " + std::to_string(index) + " outside of a traversal of " +
                file_.metadata().name);
  }
  if (index >= kPlacesUntilLearned) {
    learn(index - kPlacesUntilLearned + 1);
  }
  if (!cannot_learn_.empty() || !teaches(observation, settings_.gate) || index < learned_before_) {
    return;
  }
  const double offset_m = std::abs(observation.distance_m - local_map_distance_m);
  const auto known = pending_.find(index);
  if (known == pending_.end() || offset_m < known->second.offset_m) {
    pending_[index] = {std::move(observation), offset_m};
  }
}

void MapManager::learn(std::uint32_t before_index) {
  while (!pending_.empty() && pending_.begin()->first < before_index) {
    const auto& [index, pending] = *pending_.begin();
    LocalMap map = readForStrategy(index);
    const Bytes before = encodeLocalMap(map);
    perennial::learn(map, *strategy_, pending.observation);
    if (encodeLocalMap(map) != before) {  // a map that nothing changes must not grow
      file_.stage(map);
      ++updated_;
    }
    pending_.erase(pending_.begin());
  }
  learned_before_ = std::max(learned_before_, before_index);
}

std::size_t MapManager::endTraversal(bool commit, double stamp_s) {
  if (!in_traversal_) {
    throw Error("no traversal of " + file_.metadata().name + " to end");
  }
  in_traversal_ = false;
  if (!cannot_learn_.empty()) {
    return 0;
  }
  if (!commit) {
    file_.discardTraversal();
    return 0;
  }
  try {
    learn();
  } catch (...) {
    file_.discardTraversal();
    throw;
  }
  file_.commitTraversal(stamp_s);
  return updated_;
}

}  // namespace perennial
