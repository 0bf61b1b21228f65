#include "perennial/core/localisation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "perennial/core/human_text.h"

namespace perennial {
namespace {

std::size_t featuresOf(const ActiveMap& map) {
  std::size_t features = 0;
  for (const ActiveMap::Alternative& alternative : map.alternatives) {
    features += alternative.features.size();
  }
  return features;
}

}  // namespace

Localisation::Localisation(const LocalisationSettings& settings, const RegistrationSettings& registration,
                           std::size_t local_maps)
    : settings_(settings), local_maps_(local_maps), finder_(settings, registration) {}

void Localisation::look(FeatureSet view, double travelled_m) {
  travelled_m_ = travelled_m;
  finder_.seek(std::move(view));
}

void Localisation::consider(ActiveMap map) {
  auto shared = std::make_shared<const ActiveMap>(std::move(map));
  const std::size_t features = featuresOf(*shared);
  if (kept_.size() == next() && kept_features_ + features <= kMostKept) {
    kept_.push_back(shared);
    kept_features_ += features;
  }
  finder_.consider(std::move(shared));
}

std::size_t Localisation::considerKept(std::size_t most) {
  const std::size_t first = next();
  const std::size_t end = std::min(kept_.size(), first + most);
  for (std::size_t i = first; i < end; ++i) {
    finder_.consider(kept_[i]);
  }
  return next() - first;
}

std::optional<PlaceGuess> Localisation::conclude() {
  PlaceGuess guess = finder_.guess();
  if (guess.sure && earlier_) {
    compareWith(*earlier_, guess);
  }
  agreeing_ = guess.sure ? agreeing_ + 1 : 0;
  if (!guess.sure || agreeing_ >= settings_.agreeing_images) {
    earlier_.reset();
    return guess;
  }
  earlier_ = std::move(guess);
  earlier_travelled_m_ = travelled_m_;
  return std::nullopt;
}

void Localisation::compareWith(const PlaceGuess& earlier, PlaceGuess& guess) const {
  const double moved_m = guess.distance_m - earlier.distance_m;
  if (std::abs(moved_m - (travelled_m_ - earlier_travelled_m_)) > settings_.agreement_m) {
    guess.sure = false;
    guess.reason = "two images disagree: one looks like " + humanMetres(earlier.distance_m) +
                   " of the path, the next like " + humanMetres(guess.distance_m);
  }
  guess.certainty = std::min(guess.certainty, earlier.certainty);
}

std::string Localisation::progress() const {
  return "looking for the place: image " + std::to_string(agreeing_ + 1) + " of " +
         std::to_string(settings_.agreeing_images) + ", " + std::to_string(next()) + " of " +
         std::to_string(local_maps_) + " local maps compared";
}

}  // namespace perennial
