#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "perennial/core/feature.h"

namespace perennial {

/// What the robot should see at one place of the path: features, and what a map strategy keeps about them.
///
/// Parallel arrays: feature i has keypoint and descriptor `features[i]`, identity `ids[i]` and the strategy's
/// numbers `numbers[i * numbers_per_feature ...]`. The member functions keep them in step.
struct LocalMap {
  std::uint32_t index = 0;    ///< place in the sequence of local maps, from 0
  double distance_m = 0.0;    ///< distance along the taught path
  double stamp_s = 0.0;       ///< when it was taught, seconds since 1970
  std::uint32_t next_id = 0;  ///< identity of the next feature to be added; identities are never used again
  FeatureSet features;
  std::vector<std::uint32_t> ids;

  /// Name and version of the strategy whose numbers these are ("score_based/1"); empty: no numbers.
  std::string strategy;
  std::size_t numbers_per_feature = 0;
  std::vector<double> numbers;      ///< size() x numbers_per_feature, row by row
  std::vector<double> map_numbers;  ///< the strategy's numbers about this local map as a whole

  std::size_t size() const { return features.size(); }

  double* featureNumbers(std::size_t i) { return numbers.data() + i * numbers_per_feature; }
  const double* featureNumbers(std::size_t i) const { return numbers.data() + i * numbers_per_feature; }

  /// Adds a feature with a new identity and zeros for the strategy's numbers; returns its position.
  std::size_t add(const Keypoint& keypoint, const Descriptor& descriptor);

  /// Removes every feature i with `drop[i]`, keeping the order of the others. `drop` must have size()
  /// elements.
  void erase(const std::vector<bool>& drop);

  /// Takes the map over for a strategy: unless the numbers are already `name`'s, all numbers are replaced by
  /// zeros, `numbers_per_feature` a feature and none for the map as a whole. Features stay. True when it
  /// changed anything.
  bool adopt(const std::string& name, std::size_t numbers_per_feature);

  /// Empty when the arrays are in step, identities unique and below next_id, and every number finite;
  /// otherwise what is wrong. Used on everything read from a file and by the strategies' conformance suite.
  std::string problem() const;
};

}  // namespace perennial
