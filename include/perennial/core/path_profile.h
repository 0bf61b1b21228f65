#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace perennial {

/// Velocities commanded to the robot.
struct Velocity {
  double forward = 0.0;  ///< m/s, positive forward
  double angular = 0.0;  ///< rad/s, positive to the left (counter-clockwise seen from above)
  double flipper =
      0.0;  ///< rad/s of the flippers, for robots that have them (linear.x, angular.z, angular.y of cmd_vel)

  bool operator==(const Velocity& other) const {
    return forward == other.forward && angular == other.angular && flipper == other.flipper;
  }
  bool operator!=(const Velocity& other) const { return !(*this == other); }
};

/// From this distance on, the robot was driven with this velocity.
struct ProfileEntry {
  double distance_m = 0.0;
  Velocity velocity;
};

/// The taught velocities as a step function of the travelled distance.
class PathProfile {
 public:
  /// Exactly these entries, as they were stored. Throws Error unless all values are finite and distances
  /// rise.
  static PathProfile fromEntries(std::vector<ProfileEntry> entries);

  /// Appends an entry unless the velocity is unchanged. Of several entries at one distance the last one
  /// holds, so that a stop on the way does not become a stop for ever. Throws Error for a value that is not
  /// finite or a distance before the last one.
  void add(double distance_m, const Velocity& velocity);

  /// Velocity at this distance: that of the last entry at or before it; the first entry's before the first
  /// one. Zero for an empty profile.
  Velocity at(double distance_m) const;

  /// Velocity to repeat at this distance: as `at()`, but a stop (no forward velocity) is passed over. It
  /// gives the next velocity that travels, at the end of the path the last one: a robot that stands does not
  /// reach the distance at which it was taught to go on. Zero only if nothing in the profile travels.
  Velocity travellingAt(double distance_m) const;

  const std::vector<ProfileEntry>& entries() const { return entries_; }
  bool empty() const { return entries_.empty(); }

 private:
  /// The entry that holds at this distance; end() for an empty profile.
  std::vector<ProfileEntry>::const_iterator entryAt(double distance_m) const;

  std::vector<ProfileEntry> entries_;
};

}  // namespace perennial
