#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "perennial/core/feature.h"
#include "perennial/core/learning.h"
#include "perennial/core/map_strategy.h"
#include "perennial/core/registration.h"

namespace perennial {

/// What a camera saw at a place, as features.
struct ReplayView {
  std::shared_ptr<const FeatureSet> features;
  double stamp_s = 0.0;
};

/// A place taught once and seen again later, in order of time.
struct ReplayPlace {
  std::uint32_t index = 0;
  double distance_m = 0.0;
  ReplayView taught;
  std::vector<ReplayView> views;
};

/// What came of one view.
struct ReplayStep {
  std::optional<double> displacement_px;
  int inliers = 0;
  int matches = 0;
  std::size_t map_features = 0;  ///< features of the local map when the view was registered, used or not
  double registration_ms = 0.0;  ///< choosing the features and registering, processor time of this thread
  double learning_ms = 0.0;      ///< likewise; 0 where nothing was learned
};

/// How long features live: `dropped[n]` were dropped by the n-th traversal after the one that brought them,
/// `kept[n]` are still there n traversals after.
struct FeatureLives {
  std::vector<std::size_t> dropped;
  std::vector<std::size_t> kept;

  void add(const FeatureLives& other);
};

struct PlaceReplayResult {
  std::vector<ReplayStep> steps;  ///< one per view
  FeatureLives lives;
};

/// Teaches one local map and replays all later views of its place through what runs on the robot: the
/// strategy chooses features, the view is registered, and the map learns from it where the registration
/// passes the gate. Deterministic but for the times. Safe to use from several threads with a strategy each.
PlaceReplayResult replayPlace(const ReplayPlace& place, const MapStrategy& strategy,
                              const RegistrationSettings& registration, const LearningGate& gate);

}  // namespace perennial
