#pragma once

#include <string>

#include "perennial/core/map_strategy.h"
#include "perennial/core/map_update.h"

namespace perennial::strategies {

/// "strict": features that were matched incorrectly give way to new ones, as far as the view has any, the
/// oldest first (Halodova et al., IROS 2019). What is merely not seen stays.
class StrictMap : public MapStrategy {
 public:
  std::string name() const override { return "strict"; }
  void configure(ParameterReader& reader) override { adding_ = AddSettings::load(reader); }
  void update(LocalMap& map, const Observation& observation) const override;

 private:
  AddSettings adding_;
};

}  // namespace perennial::strategies
