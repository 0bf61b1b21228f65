#pragma once

#include <memory>
#include <pluginlib/class_loader.hpp>
#include <string>
#include <vector>

#include "perennial/core/map_strategy.h"

namespace perennial {

/// Loads map strategies, those of this package and of any other that declares one, by name. Needs no roscore,
/// only the package path of a sourced workspace. Must outlive what it loaded.
class StrategyLoader {
 public:
  StrategyLoader();

  /// Names that can be loaded, sorted: "latest", "score_based", "static", and those of other packages.
  std::vector<std::string> names();

  /// Throws ParameterError when there is no such strategy (the message lists those that exist) or its library
  /// cannot be loaded. `configure` has not been called yet.
  std::shared_ptr<MapStrategy> load(const std::string& name);

 private:
  pluginlib::ClassLoader<MapStrategy> loader_;
};

}  // namespace perennial
