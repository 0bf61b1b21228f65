#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "perennial/core/fremen_model.h"
#include "perennial/core/map_strategy.h"
#include "perennial/core/map_update.h"
#include "perennial/strategies/score_based.h"

namespace perennial::strategies {

/// "fremen": keeps more features than it uses, models how well each of them serves over time by frequency map
/// enhancement, and uses those that are predicted to serve best now; the worst in the mean give way to new
/// ones (Halodova et al., IROS 2019, section III.C.7).
///
/// Times are taken from when the local map was taught. The map's own numbers are the candidate periods, so
/// that a feature's history is never read with other periods than it was written with: after a change of
/// `periods_s` histories begin anew.
class FremenMap : public MapStrategy {
 public:
  struct Settings {
    FremenSettings model;
    ScoreSettings scores;
    ExchangeSettings exchange;
    int features_used = 500;     ///< m: the best predicted scores are used; 0: all features
    int features_kept = 750;     ///< the map grows to this size before anything is dropped
    double score_unknown = 0.0;  ///< predicted for a feature that was never used yet
  };

  FremenMap() : model_(settings_.model) {}

  std::string name() const override { return "fremen"; }
  void configure(ParameterReader& reader) override;
  /// The state of its model, see FremenModel.
  std::size_t numbersPerFeature() const override { return model_.stateSize(); }
  std::size_t maxFeatures(std::size_t taught, std::size_t seen) const override;
  Alternatives alternatives(const LocalMap& map, double stamp_s) const override;
  void update(LocalMap& map, const Observation& observation) const override;

 private:
  /// Whether the numbers were written with the present periods.
  bool readable(const LocalMap& map) const { return map.map_numbers == model_.settings().periods_s; }
  void sample(LocalMap& map, const Observation& observation) const;
  void exchange(LocalMap& map, const Observation& observation) const;

  Settings settings_;
  FremenModel model_;
};

}  // namespace perennial::strategies
