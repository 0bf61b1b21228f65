#include "perennial/evaluation/replay.h"

#include <algorithm>
#include <ctime>
#include <unordered_map>
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
  return map;
}

/// Follows the identities in a local map from one traversal to the next.
class LifeRecorder {
 public:
  explicit LifeRecorder(const LocalMap& map) { record(map, 0); }

  void record(const LocalMap& map, std::size_t traversal) {
    std::unordered_map<std::uint32_t, std::size_t> born;
    born.reserve(map.size());
    for (const std::uint32_t id : map.ids) {
      const auto known = born_.find(id);
      born.emplace(id, known == born_.end() ? traversal : known->second);
    }
    for (const auto& [id, since] : born_) {
      if (born.count(id) == 0) {
        count(lives_.dropped, traversal - since);
      }
    }
    born_ = std::move(born);
  }

  FeatureLives finish(std::size_t traversal) {
    for (const auto& entry : born_) {
      count(lives_.kept, traversal - entry.second);
    }
    return std::move(lives_);
  }

 private:
  static void count(std::vector<std::size_t>& counts, std::size_t age) {
    counts.resize(std::max(counts.size(), age + 1));
    ++counts[age];
  }

  std::unordered_map<std::uint32_t, std::size_t> born_;
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
                              const RegistrationSettings& registration_settings, int min_inliers_for_update) {
  const HistogramRegistration registration(registration_settings);
  LocalMap map = teach(place);
  takeOver(map, strategy);
  LifeRecorder lives(map);
  PlaceReplayResult result;
  for (const ReplayView& view : place.views) {
    const double start_ms = threadMilliseconds();
    const ActiveMap active = activate(strategy, map, view.stamp_s);
    ActiveRegistration registered = registerView(registration, active, *view.features);
    const RegistrationResult& found = registered.result;
    result.steps.push_back(
        {found.displacement_px, found.inliers, found.matches, map.size(), threadMilliseconds() - start_ms});

    Observation observation;
    const auto& used = active.alternatives[registered.alternative].positions;
    observation.used.assign(used.begin(), used.end());
    observation.registration = std::move(registered.result);
    observation.view = *view.features;
    observation.stamp_s = view.stamp_s;
    observation.distance_m = place.distance_m;
    if (teaches(observation, min_inliers_for_update)) {
      learn(map, strategy, observation);
    }
    lives.record(map, result.steps.size());
  }
  result.lives = lives.finish(result.steps.size());
  return result;
}

}  // namespace perennial
