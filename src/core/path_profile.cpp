#include "perennial/core/path_profile.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "perennial/core/error.h"

namespace perennial {
namespace {

bool isFinite(double distance_m, const Velocity& velocity) {
  return std::isfinite(distance_m) && std::isfinite(velocity.forward) && std::isfinite(velocity.angular) &&
         std::isfinite(velocity.flipper);
}

}  // namespace

PathProfile PathProfile::fromEntries(std::vector<ProfileEntry> entries) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const bool rises = i == 0 || entries[i].distance_m > entries[i - 1].distance_m;
    if (!rises || !isFinite(entries[i].distance_m, entries[i].velocity)) {
      throw Error("path profile: entry " + std::to_string(i) + " is not finite or not after the one before");
    }
  }
  PathProfile profile;
  profile.entries_ = std::move(entries);
  return profile;
}

void PathProfile::add(double distance_m, const Velocity& velocity) {
  if (!isFinite(distance_m, velocity)) {
    throw Error("path profile: entry " + std::to_string(entries_.size()) + " has a value that is not finite");
  }
  if (!entries_.empty()) {
    ProfileEntry& last = entries_.back();
    if (distance_m < last.distance_m) {
      throw Error("path profile: entry " + std::to_string(entries_.size()) + " at " +
                  std::to_string(distance_m) + " m lies before the last one at " +
                  std::to_string(last.distance_m) + " m");
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

std::vector<ProfileEntry>::const_iterator PathProfile::entryAt(double distance_m) const {
  const auto after = std::upper_bound(
      entries_.begin(), entries_.end(), distance_m,
      [](double distance, const ProfileEntry& entry) { return distance < entry.distance_m; });
  return after == entries_.begin() ? after : std::prev(after);
}

Velocity PathProfile::at(double distance_m) const {
  const auto entry = entryAt(distance_m);
  return entry == entries_.end() ? Velocity{} : entry->velocity;
}

Velocity PathProfile::travellingAt(double distance_m) const {
  const auto travels = [](const ProfileEntry& entry) { return entry.velocity.forward != 0.0; };
  const auto here = entryAt(distance_m);
  const auto next = std::find_if(here, entries_.end(), travels);
  if (next != entries_.end()) {
    return next->velocity;
  }
  const auto last = std::find_if(entries_.rbegin(), entries_.rend(), travels);
  return last == entries_.rend() ? Velocity{} : last->velocity;
}

}  // namespace perennial
