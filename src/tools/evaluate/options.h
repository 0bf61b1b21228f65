#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "perennial/evaluation/replay_input.h"

namespace perennial {

extern const char* const kEvaluateUsage;

/// What `evaluate` is asked to do.
struct EvaluateOptions {
  std::string dataset;  ///< folder; empty when bags are given
  std::vector<std::string> bags;
  std::string ground_truth;  ///< of the bags
  std::string image_topic = "/camera/image_raw";
  std::string out;
  std::string strategy;
  std::string sweep;
  std::vector<std::string> assignments;
  ReplaySelection selection;
  std::size_t skip_first = 0;
  std::size_t repeat = 0;
  bool stored_features = false;
  unsigned threads = 0;
  std::string cache = defaultCacheFolder();
};

/// Throws ParameterError for anything that is not understood.
EvaluateOptions parseEvaluateOptions(const std::vector<std::string>& arguments);

}  // namespace perennial
