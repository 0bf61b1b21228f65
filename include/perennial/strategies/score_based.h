#pragma once

#include <cstddef>
#include <string>

#include "perennial/core/map_strategy.h"
#include "perennial/core/map_update.h"

namespace perennial::strategies {

/// What a feature's part in a registration is worth.
struct ScoreSettings {
  double score_correct = 1.0;      ///< s_c, added for a correct match
  double score_incorrect = 1.0;    ///< s_i, subtracted for an incorrect match
  double score_not_matched = 0.0;  ///< s_n, subtracted for no match

  /// Keys as the members are called. Throws ParameterError.
  static ScoreSettings load(ParameterReader& reader);

  double of(FeatureState state) const;
};

/// "score_based": every feature has a score that grows when the feature is matched correctly and falls when
/// it is not; after each traversal the features with the worst scores give way to new ones (Halodova et al.,
/// IROS 2019, section III.C.6). Among equal scores a feature that was never matched correctly goes first,
/// then the oldest; the newest are used.
class ScoreBased : public MapStrategy {
 public:
  struct Settings {
    ScoreSettings scores;
    ExchangeSettings exchange;
    int features_used = 0;  ///< m: the best scores are used; 0: all features
    int features_kept =
        0;  ///< the map grows to this size before anything is dropped; 0: stays as large as taught
  };

  std::string name() const override { return "score_based"; }
  void configure(ParameterReader& reader) override;
  /// The score, and how often the feature was matched correctly.
  std::size_t numbersPerFeature() const override { return 2; }
  std::size_t maxFeatures(std::size_t taught, std::size_t seen) const override;
  Alternatives alternatives(const LocalMap& map, double stamp_s) const override;
  void update(LocalMap& map, const Observation& observation) const override;

 private:
  void score(LocalMap& map, const Observation& observation) const;
  void exchange(LocalMap& map, const Observation& observation) const;

  Settings settings_;
};

}  // namespace perennial::strategies
