#include "perennial/ros/parameters.h"

#include <algorithm>

#include <xmlrpcpp/XmlRpcValue.h>

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

/// Keys that libraries, not this package, read from a node's private namespace.
const std::vector<std::string>& libraryKeys() {
  static const std::vector<std::string> keys{"image_transport", "diagnostic_period", "use_fqn", "tcp_nodelay"};
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

ParameterReader groupReader(const ros::NodeHandle& nh, const std::string& group) {
  const ros::NodeHandle group_nh(nh, group);
  return ParameterReader(readParameters(group_nh), group_nh.getNamespace() + "/");
}

}  // namespace perennial
