#include "perennial/evaluation/replay.h"

#include <algorithm>
#include <ctime>
#include <utility>

#include "perennial/core/active_map.h"
#include "perennial/core/learning.h"
#include "perennial/core/local_map.h"

namespace perennial {
namespace {

double threadMilliseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

LocalMap teach(const ReplayPlace& place) {
  LocalMap map;
  map.index = place.index;
  map.distance_m = place.distance_m;
  map.stamp_s = place.taught.stamp_s;
  const FeatureSet& features = *place.taught.features;
  for (std::size_t i = 0; i < features.size(); ++i) {
    map.add(features.keypoints[i], features.descriptors[i]);
  }
  map.features.edges = features.edges;
  return map;
}

/// Follows the identities in a local map from one traversal to the next.
class LifeRecorder {
 public:
  explicit LifeRecorder(const LocalMap& map) { record(map, 0); }

  void record(const LocalMap& map, std::size_t traversal) {
    std::vector<std::uint32_t> ids = map.ids;
    std::sort(ids.begin(), ids.end());  // they nearly always are
    std::vector<Life> living;
    living.reserve(ids.size());
    auto old = living_.begin();
    for (const std::uint32_t id : ids) {
      for (; old != living_.end() && old->id < id; ++old) {
        count(lives_.dropped, traversal - old->born);
      }
      const bool known = old != living_.end() && old->id == id;
      living.push_back(known ? *old++ : Life{id, traversal});
    }
    for (; old != living_.end(); ++old) {
      count(lives_.dropped, traversal - old->born);
    }
    living_ = std::move(living);
  }

  FeatureLives finish(std::size_t traversal) {
    for (const Life& life : living_) {
      count(lives_.kept, traversal - life.born);
    }
    return std::move(lives_);
  }

 private:
  struct Life {
    std::uint32_t id = 0;
    std::size_t born = 0;
  };

  static void count(std::vector<std::size_t>& counts, std::size_t age) {
    counts.resize(std::max(counts.size(), age + 1));
    ++counts[age];
  }

  std::vector<Life> living_;  ///< by identity
  FeatureLives lives_;
};

void addTo(std::vector<std::size_t>& sums, const std::vector<std::size_t>& counts) {
  sums.resize(std::max(sums.size(), counts.size()));
  for (std::size_t i = 0; i < counts.size(); ++i) {
    sums[i] += counts[i];
  }
}

}  // namespace

void FeatureLives::add(const FeatureLives& other) {
  addTo(dropped, other.dropped);
  addTo(kept, other.kept);
}

PlaceReplayResult replayPlace(const ReplayPlace& place, const MapStrategy& strategy,
                              const RegistrationSettings& registration_settings, const LearningGate& gate) {
  const auto registration = makeRegistration(registration_settings);
  LocalMap map = teach(place);
  takeOver(map, strategy);
  LifeRecorder lives(map);
  PlaceReplayResult result;
  for (const ReplayView& view : place.views) {
    const double start_ms = threadMilliseconds();
    const ActiveMap active = activate(strategy, map, view.stamp_s);
    ActiveRegistration registered = registerView(*registration, active, *view.features);
    const RegistrationResult& found = registered.result;
    result.steps.push_back({found.displacement_px, found.inliers, found.matches, map.size(),
                            threadMilliseconds() - start_ms, 0.0});

    Observation observation;
    const auto& used = active.alternatives[registered.alternative].positions;
    observation.used.assign(used.begin(), used.end());
    observation.registration = std::move(registered.result);
    observation.view = *view.features;
    observation.stamp_s = view.stamp_s;
    observation.distance_m = place.distance_m;
    if (teaches(observation, gate)) {
      const double learning_start_ms = threadMilliseconds();
      learn(map, strategy, observation);
      result.steps.back().learning_ms = threadMilliseconds() - learning_start_ms;
    }
    lives.record(map, result.steps.size());
  }
  result.lives = lives.finish(result.steps.size());
  return result;
}

}  // namespace perennial
