#pragma once

#include <cstddef>
#include <vector>

#include "perennial/core/local_map.h"
#include "perennial/core/map_strategy.h"
#include "perennial/core/parameter_reader.h"

/// Steps that map strategies are made of.
namespace perennial {

/// Which new features come first.
struct AddSettings {
  /// Features drawn at random instead of those least like anything in the map: what Halodova et al. compared
  /// their way of adding with. Seeded from the local map and the observation's stamp: the same again every
  /// time.
  bool random_add = false;

  /// Keys as the members are called. Throws ParameterError.
  static AddSettings load(ParameterReader& reader);
};

/// View features that no map feature is paired with, those least like anything in the map first: ordered by
/// falling Hamming distance to their nearest feature of the local map (all its features, used or not), equal
/// ones by index. With `random_add` in random order.
std::vector<std::size_t> newFeatures(const LocalMap& map, const Observation& observation,
                                     const AddSettings& settings = {});

/// Adds these features of the view to the map, in the map's frame: at x_view + displacement. The
/// observation's registration must have a displacement.
void insertFromView(LocalMap& map, const Observation& observation,
                    const std::vector<std::size_t>& view_indices);

/// How many features a strategy exchanges per traversal.
struct ExchangeSettings {
  double exchange = 0.05;  ///< as a share of the local map's features, 0..1
  int exchange_count = 0;  ///< as a number, used instead of the share unless it is 0
  AddSettings adding;

  /// Keys as the members are called. Throws ParameterError.
  static ExchangeSettings load(ParameterReader& reader, double default_exchange = 0.05);

  /// For a map of this size.
  std::size_t countFor(std::size_t features) const;
};

/// Adds the view features `incoming` and drops the first ones of `drop_order` (positions in the map) to keep
/// within `capacity` features, or within the present size where that is larger. Never drops what is not
/// replaced: `incoming` is cut where there is neither room nor anything left to drop.
void exchangeFeatures(LocalMap& map, const Observation& observation,
                      const std::vector<std::size_t>& drop_order, std::vector<std::size_t> incoming,
                      std::size_t capacity);

/// Positions in the map of the used features that ended in this state, ascending.
std::vector<std::size_t> featuresIn(const Observation& observation, FeatureState state);

/// All positions, the worst score first. Among equal scores a feature that never proved itself goes before
/// one that did, then the oldest first.
std::vector<std::size_t> worstFirst(const LocalMap& map, const std::vector<double>& scores,
                                    const std::vector<bool>& proven);

/// Positions, ascending, of the `count` features with the best scores, of equal ones the newest. 0: all of
/// them.
std::vector<std::size_t> bestFeatures(const LocalMap& map, const std::vector<double>& scores,
                                      std::size_t count);

}  // namespace perennial
