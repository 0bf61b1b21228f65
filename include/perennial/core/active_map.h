#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "perennial/core/feature.h"
#include "perennial/core/local_map.h"
#include "perennial/core/map_strategy.h"
#include "perennial/core/registration.h"

namespace perennial {

/// A local map as its strategy wants it used in this traversal.
struct ActiveMap {
  struct Alternative {
    FeatureSet features;
    std::vector<std::uint32_t> positions;  ///< of each feature: its position in the stored local map
  };

  std::uint32_t index = 0;
  double distance_m = 0.0;
  std::vector<Alternative> alternatives;  ///< at least one
};

/// A local map as the strategy wants it used at this time. The map's numbers must be the strategy's (see
/// takeOver() in learning.h).
ActiveMap activate(const MapStrategy& strategy, const LocalMap& map, double stamp_s);

/// Registration against a local map: the result for the alternative that won.
struct ActiveRegistration {
  std::size_t alternative = 0;
  RegistrationResult result;
};

/// Registers a view against every alternative; the one with the most inliers wins, of equal ones the first.
ActiveRegistration registerView(const Registration& registration, const ActiveMap& map,
                                const FeatureSet& view);

/// Memory that registrations against local maps work in, see RegistrationWorkspace.
struct ActiveRegistrationWorkspace {
  RegistrationWorkspace registration;
  RegistrationResult candidate;
};

/// The same into a result whose memory is used again.
void registerInto(const Registration& registration, const ActiveMap& map, const FeatureSet& view,
                  ActiveRegistrationWorkspace& workspace, ActiveRegistration& result);

/// The local maps around the robot, as they were sent ahead. Not thread-safe.
class ActiveMapWindow {
 public:
  /// `path_size`: number of local maps of the whole path. Forgets everything held.
  void reset(std::size_t path_size);

  /// Maps must come in order of their index; one that is held already is replaced, the one before the first
  /// is put in front, one after a gap starts anew.
  void add(ActiveMap map);

  /// The local map nearest in distance; of two equally near the earlier one. nullptr when that map is not
  /// among those held: when the nearest one held is the first or last of them and a nearer one may exist
  /// beyond.
  const ActiveMap* nearest(double distance_m) const;

  /// Index of the first local map held, when one before it may be nearer to this distance.
  std::optional<std::uint32_t> firstBeyond(double distance_m) const;

  /// The local map with this index; nullptr when it is not held.
  const ActiveMap* find(std::uint32_t index) const;

  /// Forgets maps that lie more than `keep_m` before this distance.
  void forgetBefore(double distance_m, double keep_m);

  std::size_t size() const { return maps_.size(); }

 private:
  std::size_t path_size_ = 0;
  std::deque<ActiveMap> maps_;
};

}  // namespace perennial
