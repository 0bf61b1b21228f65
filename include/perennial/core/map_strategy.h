#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "perennial/core/local_map.h"
#include "perennial/core/parameter_reader.h"
#include "perennial/core/registration.h"

namespace perennial {

/// What a traversal saw at a local map: the view taken nearest to the local map's distance, and its
/// registration.
struct Observation {
  FeatureSet view;
  RegistrationResult registration;  ///< against the features `used`; has a displacement
  std::vector<std::size_t> used;    ///< positions in the local map of the features that were registered
  double stamp_s = 0.0;             ///< when the view was taken, seconds since 1970
  double distance_m = 0.0;          ///< where on the path
};

/// Sets of features to register a view against; each is a list of positions in the local map, ascending.
/// Usually one. Where there are several, the view is registered against each, and the one with the most
/// inliers counts.
using Alternatives = std::vector<std::vector<std::size_t>>;

/// A policy of which features a local map keeps, drops, adds and uses. Loaded by name as a pluginlib plugin
/// (base class `perennial::MapStrategy`), from this package or any other; see examples/.
///
/// Lifecycle: default-constructed; `configure` once; then, for every local map the robot comes near,
/// `alternatives`, and, once per local map and traversal, `update` with what was seen there. A strategy has
/// no state of its own between calls: what it wants to remember of a feature it keeps in the local map's
/// numbers, which are stored with the map, under `name()` and `version()`. A local map that carries another
/// strategy's numbers (or none) is handed over with zeros (LocalMap::adopt).
///
/// Threads: one instance is called by one thread at a time. The same calls give the same results: a strategy
/// that draws random numbers seeds them from the local map and the stamp.
///
/// Errors: `configure` throws ParameterError. The other methods do not throw for any valid local map.
class MapStrategy {
 public:
  virtual ~MapStrategy() = default;

  /// Reads the strategy's own parameters; unknown ones are refused by the caller.
  virtual void configure(ParameterReader& /*reader*/) {}

  /// Changes the meaning of the stored numbers: increase it with every such change.
  virtual int version() const { return 1; }

  /// How many numbers it keeps about each feature.
  virtual std::size_t numbersPerFeature() const { return 0; }

  /// The most features a local map may come to hold that was taught with `taught` ones and learns from views
  /// of at most `seen`. By default a map does not outgrow them. Memory is bounded by this: it must not grow
  /// without end.
  virtual std::size_t maxFeatures(std::size_t taught, std::size_t seen) const {
    return std::max(taught, seen);
  }

  /// Features to use at this time. By default all, as a single alternative.
  virtual Alternatives alternatives(const LocalMap& map, double stamp_s) const;

  /// The name under which it is declared as a plugin, without a package: "static".
  virtual std::string name() const = 0;

  /// Learns from an observation. Called only when the registration found a displacement.
  virtual void update(LocalMap& map, const Observation& observation) const = 0;
};

/// Under what a strategy's numbers are stored in a local map: "score_based/1".
std::string numbersOwner(const MapStrategy& strategy);

}  // namespace perennial
