#include "perennial/park/conditions_yaml.h"

#include <yaml-cpp/yaml.h>

#include "perennial/core/error.h"

namespace perennial::park {
namespace {

/// A quoted scalar is a text; a plain one is what YAML's core schema makes of it.
ParameterValue valueOf(const YAML::Node& node) {
  if (node.Tag() != "!") {
    int integer = 0;
    double real = 0.0;
    bool boolean = false;
    if (YAML::convert<int>::decode(node, integer)) {
      return integer;
    }
    if (YAML::convert<double>::decode(node, real)) {
      return real;
    }
    // "on" and "off" are values of the searchlight here, not truth values.
    if ((node.Scalar() == "true" || node.Scalar() == "false") && YAML::convert<bool>::decode(node, boolean)) {
      return boolean;
    }
  }
  return node.Scalar();
}

}  // namespace

Conditions mergedConditions(const Conditions& base, const std::string& yaml) {
  Parameters values;
  try {
    const YAML::Node root = YAML::Load(yaml);
    if (!root.IsMap()) {
      throw ParameterError("conditions must be a YAML mapping such as {weather: rain}, but are: " + yaml);
    }
    for (const auto& entry : root) {
      if (!entry.second.IsScalar()) {
        throw ParameterError("condition " + entry.first.as<std::string>() + " must be a single value");
      }
      values[entry.first.as<std::string>()] = valueOf(entry.second);
    }
  } catch (const YAML::Exception& error) {
    throw ParameterError(std::string("conditions are not YAML: ") + error.what());
  }
  ParameterReader reader(values, "conditions/");
  const Conditions merged = Conditions::load(reader, base);
  reader.requireAllUsed();
  return merged;
}

}  // namespace perennial::park
