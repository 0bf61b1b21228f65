#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "perennial/core/active_map.h"
#include "perennial/core/feature.h"
#include "perennial/core/parameter_reader.h"
#include "perennial/core/registration.h"

namespace perennial {

struct LocalisationSettings {
  double min_confidence = 0.9;  ///< of the registration; lower: nothing was recognised
  double rival_share = 0.6;     ///< another place with this share of the best one's inliers: ambiguous
  double elsewhere_m = 3.0;     ///< nearer to each other along the path, local maps see the same place
  int agreeing_images = 2;      ///< so many images in a row must give the same place
  double agreement_m = 1.0;     ///< within this distance
  bool loop = false;            ///< the path is closed: its ends are one place, the beginning

  /// Keys as the members are called. Throws ParameterError.
  static LocalisationSettings load(ParameterReader& reader);
};

/// Where on a path a view was taken, and how sure that is.
struct PlaceGuess {
  bool sure = false;
  double distance_m = 0.0;
  std::uint32_t index = 0;  ///< of the local map
  double certainty = 0.0;   ///< 0 to 1: confidence of the registration, less what speaks for another place
  int inliers = 0;
  std::string reason;  ///< for a person: where, or why not
};

/// Finds a view among all local maps of a path, which pass by once: the strongest features of the view are
/// registered against every local map, and the whole view against those of the likeliest stretches, which
/// alone are kept, so that memory does not grow with the path. Not sure when no place is recognised, or when
/// another place speaks for itself nearly as well. A path does not know whether it is closed: only when the
/// settings say so its two ends are one place, the beginning, and else two that may be confused. Not
/// thread-safe.
class PlaceFinder {
 public:
  explicit PlaceFinder(const LocalisationSettings& settings = {},
                       const RegistrationSettings& registration = {});

  /// Begins to seek a view; an earlier search is forgotten.
  void seek(FeatureSet view);
  /// The next local map of the path, in order of distance. Needs a view.
  void consider(std::shared_ptr<const ActiveMap> map);
  /// Local maps considered for this view.
  std::size_t considered() const { return considered_; }
  /// After the last local map.
  PlaceGuess guess();

 private:
  /// Successive local maps of about a metre.
  struct Stretch {
    struct Member {
      std::shared_ptr<const ActiveMap> map;
      int inliers = 0;
    };
    std::vector<Member> members;
    double begin_m = 0.0;
    int inliers = 0;  ///< of the best member, with the strongest features
  };
  struct Candidate {
    double distance_m = 0.0;
    std::uint32_t index = 0;
    int inliers = 0;
    double confidence = 0.0;
    bool recognised = false;
  };

  int judgeRoughly(const ActiveMap& map);
  Candidate judge(const ActiveMap& map);
  void closeStretch();
  std::vector<Candidate> likeliest();
  bool acrossTheEnds(const Candidate& a, const Candidate& b) const;
  bool samePlace(const Candidate& a, const Candidate& b) const;
  PlaceGuess ambiguous(const Candidate& best, const Candidate& rival) const;
  Candidate beginningOfLoop(const std::vector<Candidate>& candidates) const;

  LocalisationSettings settings_;
  std::unique_ptr<Registration> registration_;
  FeatureSet view_;
  FeatureSet strongest_;
  std::vector<Stretch> stretches_;  ///< the likeliest so far
  Stretch open_;                    ///< the newest, still growing
  std::size_t considered_ = 0;
  double first_m_ = 0.0;
  double last_m_ = 0.0;
  ActiveRegistrationWorkspace workspace_;
  ActiveRegistration result_;
};

}  // namespace perennial
