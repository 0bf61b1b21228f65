#include "perennial/core/active_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace perennial {

ActiveMap activate(const MapStrategy& strategy, const LocalMap& map, double stamp_s) {
  ActiveMap active;
  active.index = map.index;
  active.distance_m = map.distance_m;
  for (const std::vector<std::size_t>& selected : strategy.alternatives(map, stamp_s)) {
    ActiveMap::Alternative alternative;
    alternative.features.reserve(selected.size());
    alternative.positions.reserve(selected.size());
    for (const std::size_t i : selected) {
      alternative.features.add(map.features.keypoints.at(i), map.features.descriptors.at(i));
      alternative.positions.push_back(static_cast<std::uint32_t>(i));
    }
    alternative.features.edges = map.features.edges;
    active.alternatives.push_back(std::move(alternative));
  }
  return active;
}

ActiveRegistration registerView(const Registration& registration, const ActiveMap& map,
                                const FeatureSet& view) {
  ActiveRegistrationWorkspace workspace;
  ActiveRegistration best;
  registerInto(registration, map, view, workspace, best);
  return best;
}

void registerInto(const Registration& registration, const ActiveMap& map, const FeatureSet& view,
                  ActiveRegistrationWorkspace& workspace, ActiveRegistration& result) {
  for (std::size_t k = 0; k < map.alternatives.size(); ++k) {
    registration.registerInto(map.alternatives[k].features, view, workspace.registration,
                              workspace.candidate);
    if (k == 0 || workspace.candidate.inliers > result.result.inliers) {
      result.alternative = k;
      std::swap(result.result, workspace.candidate);
    }
  }
}

void ActiveMapWindow::reset(std::size_t path_size) {
  path_size_ = path_size;
  maps_.clear();
}

void ActiveMapWindow::add(ActiveMap map) {
  if (!maps_.empty() && map.index >= maps_.front().index && map.index <= maps_.back().index) {
    maps_[map.index - maps_.front().index] = std::move(map);
    return;
  }
  if (!maps_.empty() && map.index + 1 == maps_.front().index) {
    maps_.push_front(std::move(map));
    return;
  }
  if (!maps_.empty() && map.index != maps_.back().index + 1) {
    maps_.clear();
  }
  maps_.push_back(std::move(map));
}

const ActiveMap* ActiveMapWindow::nearest(double distance_m) const {
  if (maps_.empty()) {
    return nullptr;
  }
  const auto best = std::min_element(maps_.begin(), maps_.end(), [&](const ActiveMap& a, const ActiveMap& b) {
    return std::abs(a.distance_m - distance_m) < std::abs(b.distance_m - distance_m);
  });
  const bool may_be_nearer_before = best == maps_.begin() && best->index > 0 && distance_m < best->distance_m;
  const bool may_be_nearer_after =
      best == std::prev(maps_.end()) && (best->index + 1 < path_size_) && distance_m > best->distance_m;
  if (may_be_nearer_before || may_be_nearer_after) {
    return nullptr;
  }
  return &*best;
}

std::optional<std::uint32_t> ActiveMapWindow::firstBeyond(double distance_m) const {
  if (maps_.empty() || maps_.front().index == 0 || distance_m >= maps_.front().distance_m) {
    return std::nullopt;
  }
  return maps_.front().index;
}

const ActiveMap* ActiveMapWindow::find(std::uint32_t index) const {
  const bool held = !maps_.empty() && index >= maps_.front().index && index <= maps_.back().index;
  return held ? &maps_[index - maps_.front().index] : nullptr;
}

void ActiveMapWindow::forgetBefore(double distance_m, double keep_m) {
  while (maps_.size() > 1 && maps_.front().distance_m < distance_m - keep_m) {
    maps_.pop_front();
  }
}

}  // namespace perennial
