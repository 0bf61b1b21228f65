#pragma once

#include <cstddef>
#include <string>

#include "perennial/core/map_strategy.h"

namespace perennial::strategies {

/// "score_based": every feature has a score that grows when the feature is matched correctly and falls when it is not;
/// after each traversal the features with the worst scores give way to new ones (Halodova et al., IROS 2019,
/// section III.C.6). Among equal scores a feature that was never matched correctly goes first, then the oldest.
class ScoreBased : public MapStrategy {
 public:
  struct Settings {
    double exchange = 0.05;        ///< share of the local map's features exchanged per traversal, 0..1
    double score_correct = 1.0;    ///< s_c, added for a correct match
    double score_incorrect = 1.0;  ///< s_i, subtracted for an incorrect match
    double score_not_matched = 0.0;  ///< s_n, subtracted for no match
  };

  std::string name() const override { return "score_based"; }
  void configure(ParameterReader& reader) override;
  /// The score, and how often the feature was matched correctly.
  std::size_t numbersPerFeature() const override { return 2; }
  void update(LocalMap& map, const Observation& observation) const override;

  const Settings& settings() const { return settings_; }

 private:
  void score(LocalMap& map, const Observation& observation) const;
  void exchange(LocalMap& map, const Observation& observation) const;

  Settings settings_;
};

}  // namespace perennial::strategies
