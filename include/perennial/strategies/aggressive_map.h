#pragma once

#include <string>

#include "perennial/core/map_strategy.h"
#include "perennial/core/map_update.h"

namespace perennial::strategies {

/// "aggressive": every feature that was not matched correctly gives way to a new one (Halodova et al., IROS
/// 2019). Where the view has fewer new features, those matched incorrectly go first, then the unmatched, the
/// oldest first.
class AggressiveMap : public MapStrategy {
 public:
  std::string name() const override { return "aggressive"; }
  void configure(ParameterReader& reader) override { adding_ = AddSettings::load(reader); }
  void update(LocalMap& map, const Observation& observation) const override;

 private:
  AddSettings adding_;
};

}  // namespace perennial::strategies
