#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "perennial/core/map_strategy.h"
#include "perennial/core/map_update.h"
#include "perennial/strategies/score_based.h"

namespace perennial::strategies {

/// "anchored": a map that does not drift. Where other strategies put new features at the displacement
/// measured once and never look at it again, a local map is here a one-dimensional estimation problem: the
/// horizontal position of feature i, x_i, and the displacement of traversal t, d_t, are estimated together
/// from all pairs x_i - u_it = d_t seen so far.
///
/// The taught features are the fixed frame. Those that a traversal added form a cohort: their positions share
/// the error of that traversal's displacement (variance C) beside one of their own (variance v). Whenever a
/// cohort is seen together with others, the cohorts' mean differences are combined by their variances to the
/// traversal's displacement, and each cohort moves towards it by its Kalman gain. A cohort whose pairs agree
/// on another displacement than the weightier rest entered the map in the wrong place, and is put right at
/// once: one wrong traversal is an outlier, not a new truth. Cost and memory are constant.
///
/// Features are kept by score, as in score_based; the map grows to several times the taught one, and a share
/// of the taught features always stays, for without them there is no frame. See docs/strategies.md.
class AnchoredMap : public MapStrategy {
 public:
  struct Settings {
    ScoreSettings scores;
    AddSettings adding;
    double share = 0.7;             ///< of the view's features, added per traversal, 0..1
    int features_kept = 1500;       ///< the map grows to this size before anything is dropped
    int features_used = 0;          ///< the best scores are used; 0: all features
    double taught_share = 0.5;      ///< of the taught features, those with the best scores are never dropped
    double feature_noise_px = 2.0;  ///< standard deviation of a feature's place in an image
    double cohort_noise_px =
        2.0;                 ///< of what a traversal's displacement misses beside that: parallax above all
    double reach_px = 10.0;  ///< pairs that differ more from the displacement are outliers
    double min_lead =
        1.5;  ///< nothing is added unless the displacement has so many times the support of any other
  };

  std::string name() const override { return "anchored"; }
  void configure(ParameterReader& reader) override;
  /// Cohort (0: taught), its variance C and the feature's own v in px^2, score, how often it was matched
  /// correctly. The map's own numbers: cohorts so far, features that were taught.
  std::size_t numbersPerFeature() const override { return 5; }
  std::size_t maxFeatures(std::size_t taught, std::size_t seen) const override;
  Alternatives alternatives(const LocalMap& map, double stamp_s) const override;
  void update(LocalMap& map, const Observation& observation) const override;

 private:
  struct Pair;
  struct Estimate;

  Estimate estimate(const std::vector<Pair>& pairs) const;
  void correct(LocalMap& map, const std::vector<Pair>& pairs, const Estimate& estimate) const;
  void score(LocalMap& map, const std::vector<Pair>& pairs, const Observation& observation,
             const Estimate& estimate) const;
  void exchange(LocalMap& map, const Observation& observation, const Estimate& estimate) const;
  std::vector<std::size_t> dispensableFirst(const LocalMap& map) const;

  Settings settings_;
};

}  // namespace perennial::strategies
