#include "perennial/evaluation/run_settings.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <sstream>
#include <utility>

#include "perennial/core/error.h"
#include "perennial/core/map_manager.h"

namespace perennial {
namespace {

ParameterValue scalar(const YAML::Node& node) {
  const std::string& text = node.Scalar();
  if (text == "true" || text == "false") {
    return text == "true";
  }
  int integer = 0;
  if (YAML::convert<int>::decode(node, integer)) {
    return integer;
  }
  double real = 0.0;
  if (YAML::convert<double>::decode(node, real)) {
    return real;
  }
  return text;
}

ParameterValue parsed(const std::string& key, const std::string& text) {
  try {
    const YAML::Node node = YAML::Load(text);
    if (node.IsScalar()) {
      return scalar(node);
    }
    if (node.IsSequence()) {
      return node.as<std::vector<double>>();
    }
  } catch (const YAML::Exception&) {
    // said below
  }
  throw ParameterError(key + ": '" + text +
                       "' is neither true, false, a number, a list of numbers nor a text");
}

/// As it would be written in an assignment.
std::string textOf(const YAML::Node& node) {
  if (node.IsScalar()) {
    return node.Scalar();
  }
  std::string text = "[";
  for (const YAML::Node& element : node) {
    text += (text.size() > 1 ? ", " : "") + element.as<std::string>();
  }
  return text + "]";
}

/// A single value counts as a list of one.
std::vector<std::string> choices(const YAML::Node& node) {
  std::vector<std::string> result;
  if (node.IsSequence()) {
    for (const YAML::Node& element : node) {
      result.push_back(textOf(element));
    }
  } else {
    result.push_back(textOf(node));
  }
  return result;
}

std::vector<RunSettings> expand(const YAML::Node& grid) {
  for (const auto& entry : grid) {
    const auto key = entry.first.as<std::string>();
    if (key != "strategy" && key != "set") {
      throw ParameterError("a grid has no key '" + key + "', only: strategy, set");
    }
  }
  if (!grid["strategy"]) {
    throw ParameterError("a grid names no strategy");
  }
  std::vector<RunSettings> runs;
  for (const std::string& strategy : choices(grid["strategy"])) {
    runs.emplace_back(strategy);
  }
  for (const auto& entry : grid["set"]) {
    std::vector<RunSettings> more;
    for (const RunSettings& run : runs) {
      for (const std::string& value : choices(entry.second)) {
        more.push_back(run);
        more.back().set(entry.first.as<std::string>() + "=" + value);
      }
    }
    runs = std::move(more);
  }
  return runs;
}

}  // namespace

void RunSettings::set(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw ParameterError("'" + assignment + "' is not of the form key=value");
  }
  const std::string key = assignment.substr(0, equals);
  const std::string value = assignment.substr(equals + 1);
  const std::size_t slash = key.find('/');
  const std::string group = slash == std::string::npos ? "" : key.substr(0, slash);
  if (group != "" && group != "registration" && group != "extraction" && group != "map_manager") {
    throw ParameterError("'" + key + "': there is no group '" + group +
                         "', only registration, extraction, map_manager");
  }
  groups_[group][slash == std::string::npos ? key : key.substr(slash + 1)] = parsed(key, value);
  assignments_[key] = value;
}

std::string RunSettings::name() const {
  std::string name = strategy_;
  for (const auto& [key, value] : assignments_) {
    name.append(",").append(key).append("=").append(value);
  }
  std::replace(name.begin(), name.end(), '/', '.');
  name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
  return name;
}

ParameterReader RunSettings::reader(const std::string& group) const {
  const auto found = groups_.find(group);
  return ParameterReader(found == groups_.end() ? Parameters() : found->second,
                         group.empty() ? "" : group + "/");
}

RegistrationSettings RunSettings::registration() const {
  ParameterReader parameters = reader("registration");
  const auto settings = RegistrationSettings::load(parameters);
  parameters.requireAllUsed();
  return settings;
}

ExtractionSettings RunSettings::extraction() const {
  ParameterReader parameters = reader("extraction");
  const auto settings = ExtractionSettings::load(parameters);
  parameters.requireAllUsed();
  return settings;
}

LearningGate RunSettings::learningGate() const {
  ParameterReader parameters = reader("map_manager");
  const auto settings = MapManagerSettings::load(parameters);
  parameters.requireAllUsed();
  return settings.gate;
}

ParameterReader RunSettings::strategyReader() const { return reader(""); }

std::vector<RunSettings> loadSweep(const std::string& file, const std::vector<std::string>& common) {
  std::vector<RunSettings> runs;
  try {
    const YAML::Node document = YAML::LoadFile(file);
    if (!document["runs"] || !document["runs"].IsSequence()) {
      throw ParameterError("there is no list 'runs'");
    }
    for (const YAML::Node& grid : document["runs"]) {
      for (RunSettings& run : expand(grid)) {
        for (const std::string& assignment : common) {
          run.set(assignment);
        }
        runs.push_back(std::move(run));
      }
    }
  } catch (const YAML::Exception& error) {
    throw ParameterError(file + ": " + error.what());
  } catch (const ParameterError& error) {
    throw ParameterError(file + ": " + error.what());
  }
  return runs;
}

}  // namespace perennial
