#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "perennial/core/map_strategy.h"

namespace perennial::strategies {

/// "multiple": several alternative maps of one place, after the "experiences" of Churchill and Newman (IJRR
/// 2013), as in Halodova et al., IROS 2019. Each view is registered against all of them. When even the best
/// has too few correct matches, the view becomes a new alternative; when there are as many as allowed, it
/// replaces the one that was not the best for longest. The taught one is never replaced: the frame of all
/// others hangs on it.
///
/// Costs one registration per alternative.
class MultipleMaps : public MapStrategy {
 public:
  struct Settings {
    int min_correct = 20;       ///< correct matches that make an alternative good enough
    int max_alternatives = 10;  ///< maps of one place, the taught one included
  };

  std::string name() const override { return "multiple"; }
  void configure(ParameterReader& reader) override;
  /// The alternative that the feature belongs to; 0 is the taught one. The map's own numbers: when each
  /// alternative was the best one last.
  std::size_t numbersPerFeature() const override { return 1; }
  std::size_t maxFeatures(std::size_t taught, std::size_t seen) const override;
  Alternatives alternatives(const LocalMap& map, double stamp_s) const override;
  void update(LocalMap& map, const Observation& observation) const override;

 private:
  std::size_t alternativeToReplace(const std::vector<double>& last_best_s) const;

  Settings settings_;
};

}  // namespace perennial::strategies
