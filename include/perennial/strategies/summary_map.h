#pragma once

#include <cstddef>
#include <string>

#include "perennial/core/map_strategy.h"
#include "perennial/core/map_update.h"

namespace perennial::strategies {

/// "summary": a summary of all that was seen. Features matched incorrectly go, a share of every view is
/// added, and the map grows (Halodova et al., IROS 2019) until it is full; then what was never matched
/// correctly goes first, of that and of the rest the oldest.
class SummaryMap : public MapStrategy {
 public:
  struct Settings {
    double share = 0.1;       ///< of the view's features, added per traversal, 0..1
    int max_features = 5000;  ///< where a local map stops growing; each costs time in every registration
    AddSettings adding;
  };

  std::string name() const override { return "summary"; }
  void configure(ParameterReader& reader) override;
  /// How often the feature was matched correctly.
  std::size_t numbersPerFeature() const override { return 1; }
  std::size_t maxFeatures(std::size_t taught, std::size_t seen) const override;
  void update(LocalMap& map, const Observation& observation) const override;

 private:
  Settings settings_;
};

}  // namespace perennial::strategies
