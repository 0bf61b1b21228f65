#pragma once

#include <map>
#include <string>
#include <vector>

#include "perennial/core/feature_extractor.h"
#include "perennial/core/learning.h"
#include "perennial/core/parameter_reader.h"
#include "perennial/core/registration.h"

namespace perennial {

/// One run of an evaluation: a strategy and everything that is not by default.
class RunSettings {
 public:
  explicit RunSettings(std::string strategy) : strategy_(std::move(strategy)) {}

  /// Sets a parameter by "key=value". The key is the strategy's, or begins with the group it belongs to, as
  /// in the nodes: "registration/ratio", "extraction/features", "map_manager/min_confidence_for_update". The
  /// value is YAML: true, 5, 0.5, [1, 2], text. Throws ParameterError for anything else, not yet for unknown
  /// keys.
  void set(const std::string& assignment);

  const std::string& strategy() const { return strategy_; }
  /// What was set, as text.
  const std::map<std::string, std::string>& assignments() const { return assignments_; }
  /// Fit for a folder: "score_based,exchange=0.05".
  std::string name() const;

  /// These throw ParameterError for unknown keys and values out of range.
  RegistrationSettings registration() const;
  ExtractionSettings extraction() const;
  LearningGate learningGate() const;
  /// Of the strategy; to be read by its `configure`, then `requireAllUsed`.
  ParameterReader strategyReader() const;

 private:
  ParameterReader reader(const std::string& group) const;

  std::string strategy_;
  std::map<std::string, std::string> assignments_;
  std::map<std::string, Parameters> groups_;  ///< "" for the strategy's own
};

/// The runs of a sweep, from a YAML file with a list `runs` of grids:
///
///     runs:
///       - strategy: [static, latest]
///       - strategy: [score_based, fremen]
///         set:
///           exchange: [0.05, 0.1]
///           score_not_matched: [0, 0.5]
///
/// Every combination of a grid is a run; what `common` is given is set in all. Throws ParameterError, naming
/// the file.
std::vector<RunSettings> loadSweep(const std::string& file, const std::vector<std::string>& common);

}  // namespace perennial
