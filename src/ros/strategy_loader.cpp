#include "perennial/ros/strategy_loader.h"

#include <algorithm>

#include "perennial/core/error.h"

namespace perennial {

StrategyLoader::StrategyLoader() : loader_("perennial_nav", "perennial::MapStrategy") {}

std::vector<std::string> StrategyLoader::names() {
  std::vector<std::string> names = loader_.getDeclaredClasses();
  std::sort(names.begin(), names.end());
  return names;
}

std::shared_ptr<MapStrategy> StrategyLoader::load(const std::string& name) {
  if (!loader_.isClassAvailable(name)) {
    std::string known;
    for (const std::string& other : names()) {
      known += (known.empty() ? "" : ", ") + other;
    }
    throw ParameterError("there is no map strategy '" + name + "'; those that exist are: " + known);
  }
  try {
    const auto strategy = loader_.createInstance(name);
    // Noetic's pluginlib returns a boost::shared_ptr here, later ones may not: keep it alive either way.
    return std::shared_ptr<MapStrategy>(strategy.get(), [strategy](MapStrategy*) {});
  } catch (const pluginlib::PluginlibException& error) {
    throw ParameterError("map strategy '" + name + "' cannot be loaded: " + error.what());
  }
}

}  // namespace perennial
