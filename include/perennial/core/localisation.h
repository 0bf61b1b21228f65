#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "perennial/core/active_map.h"
#include "perennial/core/feature.h"
#include "perennial/core/place_finder.h"
#include "perennial/core/registration.h"

namespace perennial {

/// Finds where on a path a robot is, from several images in a row that must agree.
///
///     localisation.look(view, travelled_m);   // a new image
///     while (!localisation.complete()) {
///       if (localisation.considerKept(50) == 0) {
///         localisation.consider(...);         // local maps, from next() on, in order
///       }
///     }
///     localisation.conclude();                // a place, a refusal, or none: look again
///
/// The robot may move meanwhile: places are compared by how far it has travelled between the images. Local
/// maps are kept for the next image, which is compared with the very same ones; of a path that is too long
/// for that, those of its beginning. Not thread-safe.
class Localisation {
 public:
  /// Features that kept local maps may have, of all alternatives: 52 bytes each.
  static constexpr std::size_t kMostKept = 1'000'000;

  /// `local_maps`: number of local maps of the whole path.
  Localisation(const LocalisationSettings& settings, const RegistrationSettings& registration,
               std::size_t local_maps);

  void look(FeatureSet view, double travelled_m);
  /// Index of the local map to be considered next.
  std::size_t next() const { return finder_.considered(); }
  void consider(ActiveMap map);
  /// Considers up to `most` of the next local maps, as far as they were kept. Returns how many.
  std::size_t considerKept(std::size_t most);
  bool complete() const { return next() >= local_maps_; }

  /// Once it is complete. Sure: where the newest image was taken, with the least certainty of the images. Not
  /// sure: why not, for a person. None: so far so good, but another image has to agree.
  std::optional<PlaceGuess> conclude();

  /// What is being done, for a person.
  std::string progress() const;

 private:
  /// Not sure any more when the image before was taken somewhere else.
  void compareWith(const PlaceGuess& earlier, PlaceGuess& guess) const;

  LocalisationSettings settings_;
  std::size_t local_maps_;
  PlaceFinder finder_;
  std::vector<std::shared_ptr<const ActiveMap>> kept_;  ///< by index, from 0 on
  std::size_t kept_features_ = 0;
  int agreeing_ = 0;                   ///< images in a row
  double travelled_m_ = 0.0;           ///< at the newest image
  std::optional<PlaceGuess> earlier_;  ///< what the image before gave
  double earlier_travelled_m_ = 0.0;
};

}  // namespace perennial
