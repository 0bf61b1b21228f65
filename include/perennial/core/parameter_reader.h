#pragma once

#include <map>
#include <set>
#include <string>
#include <variant>
#include <vector>

namespace perennial {

using ParameterValue = std::variant<bool, int, double, std::string, std::vector<double>>;
using Parameters = std::map<std::string, ParameterValue>;

/// Reads the parameters of one component, strictly: a value of the wrong type or out of its range, and any
/// key that nobody asked for, is an error that names the key. It knows nothing of ROS, so that whatever reads
/// parameters through it (strategies above all) is tested without a node.
///
/// Typical use, in a component's `load()`:
///
///     settings.features = reader.integer("features", settings.features, 1, 10000);
///     reader.requireAllUsed();
///
/// Every method throws ParameterError. Not thread-safe.
class ParameterReader {
 public:
  /// `name_space` is put before every key in error messages, for instance "/map_manager/strategy/".
  explicit ParameterReader(Parameters values = {}, std::string name_space = "");

  bool boolean(const std::string& key, bool default_value);
  int integer(const std::string& key, int default_value, int minimum, int maximum);
  /// An integer given for a real parameter is taken as that number. NaN and infinity are out of every range.
  double real(const std::string& key, double default_value, double minimum, double maximum);
  std::string text(const std::string& key, const std::string& default_value);
  std::string choice(const std::string& key, const std::string& default_value,
                     const std::vector<std::string>& allowed);
  std::vector<double> reals(const std::string& key, const std::vector<double>& default_value, double minimum,
                            double maximum);

  /// Throws when a key was given that no method above was called with; the message lists the known keys.
  void requireAllUsed() const;

 private:
  /// Marks the key as known; nullptr when no value was given.
  const ParameterValue* find(const std::string& key);
  [[noreturn]] void fail(const std::string& key, const std::string& problem) const;

  Parameters values_;
  std::string name_space_;
  std::set<std::string> known_keys_;
};

}  // namespace perennial
