#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "perennial/core/active_map.h"
#include "perennial/core/learning.h"
#include "perennial/core/map_file.h"
#include "perennial/core/map_strategy.h"
#include "perennial/core/parameter_reader.h"

namespace perennial {

struct MapManagerSettings {
  double lookahead_m = 5.0;   ///< local maps are handed out this far ahead of the robot
  double lookbehind_m = 1.0;  ///< and this far behind it
  /// Keys: min_inliers_for_update, min_confidence_for_update.
  LearningGate gate;

  /// Keys as the members are called. Throws ParameterError.
  static MapManagerSettings load(ParameterReader& reader);
};

/// Keeps one map through its traversals: hands out local maps as the strategy wants them used, and learns,
/// once per local map and traversal, from the observation taken nearest to the local map's distance. What a
/// traversal taught is stored in one transaction at its end, or not at all. Not thread-safe. Throws MapError.
class MapManager {
 public:
  MapManager(MapFile file, std::shared_ptr<const MapStrategy> strategy,
             const MapManagerSettings& settings = {});

  /// `stamp_s`: time of the traversal, by which the strategy chooses features. An open traversal is
  /// discarded. A map of an older format that cannot be migrated now (disk full) is used as it is:
  /// cannotLearn() says why.
  void beginTraversal(double stamp_s);

  /// Why the open traversal teaches the map nothing, whatever is observed; "" when it does.
  const std::string& cannotLearn() const { return cannot_learn_; }

  /// Local maps to send for a robot at this distance: those around it that were not handed out in this
  /// traversal yet, in order, without gaps; always including the next two, however far.
  std::vector<std::uint32_t> due(double distance_m);

  /// A local map as it is used in this traversal; with the edges of the taught image where features are
  /// described by orientations. Without them some ms faster, for looking through the whole path.
  ActiveMap activeMap(std::uint32_t index) const;
  ActiveMap activeMapWithoutEdges(std::uint32_t index) const;

  /// What was seen near local map `index`, which lies at `local_map_distance_m`. Observations that do not
  /// pass the gate are ignored.
  void observe(std::uint32_t index, double local_map_distance_m, Observation observation);

  /// Learns from what is still pending and stores everything (`commit`) or forgets it. Returns how many local
  /// maps changed.
  std::size_t endTraversal(bool commit, double stamp_s);

  bool inTraversal() const { return in_traversal_; }
  const MapFile& file() const { return file_; }
  const MapStrategy& strategy() const { return *strategy_; }

 private:
  struct Pending {
    Observation observation;
    double offset_m = 0.0;  ///< of the observation from the local map
  };

  LocalMap readForStrategy(std::uint32_t index) const;
  /// Learns from the observations of local maps before `index`, and from all with the default.
  void learn(std::uint32_t before_index = ~std::uint32_t{0});

  MapFile file_;
  std::shared_ptr<const MapStrategy> strategy_;
  MapManagerSettings settings_;

  bool in_traversal_ = false;
  std::string cannot_learn_;
  double stamp_s_ = 0.0;
  std::uint32_t next_due_ = 0;
  bool handed_out_any_ = false;
  std::map<std::uint32_t, Pending> pending_;
  std::uint32_t learned_before_ = 0;  ///< local maps before this one have been learned from
  std::size_t updated_ = 0;
};

}  // namespace perennial
