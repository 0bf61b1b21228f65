#include "perennial/ros/parameters.h"

#include <xmlrpcpp/XmlRpcValue.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <variant>

#include "perennial/core/error.h"

namespace perennial {
namespace {

using XmlRpc::XmlRpcValue;

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

double number(XmlRpcValue& value, const std::string& key) {
  if (value.getType() == XmlRpcValue::TypeDouble) {
    return static_cast<double>(value);
  }
  if (value.getType() == XmlRpcValue::TypeInt) {
    return static_cast<int>(value);
  }
  throw ParameterError("parameter " + key + " must be a list of numbers");
}

ParameterValue converted(XmlRpcValue& value, const std::string& key) {
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean:
      return static_cast<bool>(value);
    case XmlRpcValue::TypeInt:
      return static_cast<int>(value);
    case XmlRpcValue::TypeDouble:
      return static_cast<double>(value);
    case XmlRpcValue::TypeString:
      return static_cast<std::string>(value);
    case XmlRpcValue::TypeArray: {
      std::vector<double> numbers;
      for (int i = 0; i < value.size(); ++i) {
        numbers.push_back(number(value[i], key));
      }
      return numbers;
    }
    default:
      throw ParameterError("parameter " + key + " has a type that no parameter of this node has");
  }
}

/// As few digits as give the same number again.
std::string shortest(double value) {
  char text[32];
  for (int digits = 6; digits <= 17; ++digits) {
    std::snprintf(text, sizeof(text), "%.*g", digits, value);
    if (std::strtod(text, nullptr) == value) {
      break;
    }
  }
  return text;
}

/// Keys that libraries, not this package, read from a node's private namespace.
const std::vector<std::string>& libraryKeys() {
  static const std::vector<std::string> keys{"image_transport", "diagnostic_period", "use_fqn",
                                             "tcp_nodelay"};
  return keys;
}

}  // namespace

Parameters readParameters(const ros::NodeHandle& nh, const std::vector<std::string>& known_groups) {
  XmlRpcValue all;
  Parameters parameters;
  if (!nh.getParam(nh.getNamespace(), all) || all.getType() != XmlRpcValue::TypeStruct) {
    return parameters;
  }
  for (auto& [key, value] : all) {
    const std::string full_key = nh.resolveName(key);
    if (value.getType() == XmlRpcValue::TypeStruct) {
      if (!contains(known_groups, key) && !contains(known_groups, "*")) {
        throw ParameterError("unknown group of parameters " + full_key + "; check its spelling");
      }
    } else if (!contains(libraryKeys(), key)) {
      parameters[key] = converted(value, full_key);
    }
  }
  return parameters;
}

std::string toText(const ParameterValue& value) {
  if (const auto* list = std::get_if<std::vector<double>>(&value)) {
    std::string text;
    for (const double element : *list) {
      text += (text.empty() ? "" : ", ") + shortest(element);
    }
    return "[" + text + "]";
  }
  if (const auto* flag = std::get_if<bool>(&value)) {
    return *flag ? "true" : "false";
  }
  if (const auto* whole = std::get_if<int>(&value)) {
    return std::to_string(*whole);
  }
  const auto* real = std::get_if<double>(&value);
  return real != nullptr ? shortest(*real) : std::get<std::string>(value);
}

ParameterReader groupReader(const ros::NodeHandle& nh, const std::string& group) {
  const ros::NodeHandle group_nh(nh, group);
  return ParameterReader(readParameters(group_nh), group_nh.getNamespace() + "/");
}

}  // namespace perennial
