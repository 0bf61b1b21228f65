#pragma once

#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "perennial/core/parameter_reader.h"

namespace perennial {

/// The parameters directly in the namespace of `nh`, for a ParameterReader. Groups (nested namespaces) are
/// left out; one that is not in `known_groups` is an error, so that a misspelt group is found, except where
/// `known_groups` holds "*". What libraries keep in a node's private namespace (image_transport,
/// diagnostic_updater) is left out too. Throws ParameterError for values of a type that no parameter has.
Parameters readParameters(const ros::NodeHandle& nh, const std::vector<std::string>& known_groups = {});

/// As it stands in YAML: "true", "5", "0.05", "[1, 2]".
std::string toText(const ParameterValue& value);

/// A reader of the parameters in group `group` of `nh`, whose errors name the full key.
ParameterReader groupReader(const ros::NodeHandle& nh, const std::string& group);

/// Loads the settings of a group strictly: `Settings::load(reader)`, and an error for every unknown key.
template <typename Settings>
Settings loadGroup(const ros::NodeHandle& nh, const std::string& group) {
  ParameterReader reader = groupReader(nh, group);
  const Settings settings = Settings::load(reader);
  reader.requireAllUsed();
  return settings;
}

/// Loads a node's own settings, those outside of any group, likewise.
template <typename Settings>
Settings loadNode(const ros::NodeHandle& private_nh, const std::vector<std::string>& known_groups) {
  ParameterReader reader(readParameters(private_nh, known_groups), private_nh.getNamespace() + "/");
  const Settings settings = Settings::load(reader);
  reader.requireAllUsed();
  return settings;
}

}  // namespace perennial
