#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "perennial/core/active_map.h"
#include "perennial/core/feature.h"
#include "perennial/core/registration.h"

namespace perennial {

/// Where on a path a view was taken, and how sure that is.
struct PlaceGuess {
  bool sure = false;
  double distance_m = 0.0;
  std::uint32_t index = 0;  ///< of the local map
  double certainty = 0.0;   ///< 0 to 1: confidence of the registration, less what speaks for another place
  int inliers = 0;
  std::string reason;  ///< for a person: where, or why not
};

/// Finds a view among all local maps of a path: the strongest features of the view against every local map,
/// then the whole view against the likeliest. Not sure when no place is recognised, or when another place,
/// more than 3 m away, speaks for itself nearly as well. The two ends of a loop are one place. Not
/// thread-safe.
class PlaceFinder {
 public:
  explicit PlaceFinder(const RegistrationSettings& settings = {});

  /// Local maps in order of their distance. Those of the path that were added before stay.
  void add(ActiveMap map) { maps_.push_back(std::move(map)); }
  std::size_t size() const { return maps_.size(); }

  PlaceGuess find(const FeatureSet& view);

 private:
  struct Candidate {
    const ActiveMap* map = nullptr;
    int inliers = 0;
    double confidence = 0.0;
    bool recognised = false;
  };

  Candidate judge(const ActiveMap& map, const FeatureSet& view);
  std::vector<Candidate> likeliest(const FeatureSet& view);
  bool endsOfALoop(const ActiveMap& a, const ActiveMap& b) const;

  std::unique_ptr<Registration> registration_;
  std::vector<ActiveMap> maps_;
  ActiveRegistrationWorkspace workspace_;
  ActiveRegistration result_;
};

}  // namespace perennial
