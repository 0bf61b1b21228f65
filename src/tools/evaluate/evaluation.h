#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "perennial/evaluation/feature_cache.h"
#include "perennial/evaluation/run_results.h"
#include "perennial/evaluation/run_settings.h"
#include "perennial/ros/strategy_loader.h"
#include "tools/evaluate/options.h"

namespace perennial {

/// All runs of one call of `evaluate`. Images are read once for each extraction setting; then every place of
/// every run is a job of its own. A run is written as soon as its last place is done.
class Evaluation {
 public:
  explicit Evaluation(EvaluateOptions options) : options_(std::move(options)), cache_(options_.cache) {}

  /// False when something was left out because of a problem; problems are said on stderr.
  bool run();

 private:
  /// The data set's folder; that of bags is made first, beside the results.
  std::string inputFolder();
  /// All runs, every setting of which was tried, so that a typo in the last one shows at once.
  std::vector<RunSettings> checkedRuns();
  std::shared_ptr<MapStrategy> create(const RunSettings& run);
  std::string folderOf(const RunSettings& run) const;
  std::string inputName(const Dataset& dataset) const;
  /// Runs that share their extraction settings.
  void runAll(const Dataset& dataset, const std::vector<SelectedPlace>& places,
              const std::vector<RunSettings>& runs);
  void write(const RunSettings& run, const ReplayInput& input, const std::vector<PlaceReplayResult>& places,
             const std::string& name) const;

  StrategyLoader loader_;  // before whatever it loads
  std::mutex loader_mutex_;
  EvaluateOptions options_;
  FeatureCache cache_;
  std::vector<std::string> problems_;
};

}  // namespace perennial
