#include "perennial/core/path_profile.h"

#include <algorithm>
#include <cmath>

#include "perennial/core/error.h"

namespace perennial {

void PathProfile::add(double distance_m, const Velocity& velocity) {
  if (!std::isfinite(distance_m) || !std::isfinite(velocity.forward) || !std::isfinite(velocity.angular) ||
      !std::isfinite(velocity.flipper)) {
    throw Error("path profile: entry " + std::to_string(entries_.size()) + " has a value that is not finite");
  }
  if (!entries_.empty()) {
    ProfileEntry& last = entries_.back();
    if (distance_m < last.distance_m) {
      throw Error("path profile: entry " + std::to_string(entries_.size()) + " at " + std::to_string(distance_m) +
                  " m lies before the last one at " + std::to_string(last.distance_m) + " m");
    }
    if (distance_m == last.distance_m) {
      last.velocity = velocity;
      return;
    }
    if (velocity == last.velocity) {
      return;
    }
  }
  entries_.push_back({distance_m, velocity});
}

Velocity PathProfile::at(double distance_m) const {
  if (entries_.empty()) {
    return {};
  }
  const auto after =
      std::upper_bound(entries_.begin(), entries_.end(), distance_m,
                       [](double distance, const ProfileEntry& entry) { return distance < entry.distance_m; });
  return after == entries_.begin() ? entries_.front().velocity : std::prev(after)->velocity;
}

}  // namespace perennial
