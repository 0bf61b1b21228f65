#pragma once

#include <perennial/core/map_strategy.h>

#include <cstddef>
#include <string>

namespace perennial_example_strategy {

/// "oldest_first": after each traversal the features that were not seen for longest give way to new ones. A
/// feature is seen when it is matched correctly; one that never was goes before all others, in the order in
/// which they came.
class OldestFirst : public perennial::MapStrategy {
 public:
  std::string name() const override { return "oldest_first"; }
  void configure(perennial::ParameterReader& reader) override;
  /// When the feature was last seen, seconds since 1970; 0: never.
  std::size_t numbersPerFeature() const override { return 1; }
  void update(perennial::LocalMap& map, const perennial::Observation& observation) const override;

 private:
  double exchange_ = 0.1;  ///< share of the local map's features exchanged per traversal
};

}  // namespace perennial_example_strategy
