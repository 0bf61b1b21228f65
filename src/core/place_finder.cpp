#include "perennial/core/place_finder.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "perennial/core/human_text.h"

namespace perennial {
namespace {

/// Features of the view that every local map is asked about.
constexpr std::size_t kStrongest = 100;
/// Local maps that the whole view is compared with.
constexpr std::size_t kShortlist = 24;
/// Neighbouring local maps see the same: only beyond this is another place.
constexpr double kElsewhere_m = 3.0;
/// Confidence below which nothing was recognised.
constexpr double kLeastConfidence = 0.9;
/// Share of the winner's pairs from which a place is about as likely.
constexpr double kAboutAsLikely = 0.8;
/// Share of the winner's pairs with which another place makes it ambiguous.
constexpr double kRivalShare = 0.6;

FeatureSet strongest(const FeatureSet& view) {
  std::vector<std::size_t> order(view.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::size_t count = std::min(kStrongest, order.size());
  std::partial_sort(
      order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
      [&](std::size_t a, std::size_t b) { return view.keypoints[a].response > view.keypoints[b].response; });
  FeatureSet result;
  for (std::size_t i = 0; i < count; ++i) {
    result.add(view.keypoints[order[i]], view.descriptors[order[i]]);
  }
  return result;
}

PlaceGuess refused(std::string reason) {
  PlaceGuess guess;
  guess.reason = std::move(reason);
  return guess;
}

}  // namespace

PlaceFinder::PlaceFinder(const RegistrationSettings& settings) : registration_(makeRegistration(settings)) {}

PlaceFinder::Candidate PlaceFinder::judge(const ActiveMap& map, const FeatureSet& view) {
  registerInto(*registration_, map, view, workspace_, result_);
  const RegistrationResult& result = result_.result;
  return {&map, result.inliers, result.confidence, result.displacement_px.has_value()};
}

std::vector<PlaceFinder::Candidate> PlaceFinder::likeliest(const FeatureSet& view) {
  const FeatureSet few = strongest(view);
  std::vector<Candidate> candidates;
  candidates.reserve(maps_.size());
  for (const ActiveMap& map : maps_) {
    candidates.push_back(judge(map, few));
  }
  const auto more = [](const Candidate& a, const Candidate& b) { return a.inliers > b.inliers; };
  std::stable_sort(candidates.begin(), candidates.end(), more);
  candidates.resize(std::min(kShortlist, candidates.size()));
  for (Candidate& candidate : candidates) {
    candidate = judge(*candidate.map, view);
  }
  std::stable_sort(candidates.begin(), candidates.end(), more);
  return candidates;
}

bool PlaceFinder::endsOfALoop(const ActiveMap& a, const ActiveMap& b) const {
  const double first_m = maps_.front().distance_m;
  const double last_m = maps_.back().distance_m;
  return std::min(a.distance_m, b.distance_m) <= first_m + kElsewhere_m &&
         std::max(a.distance_m, b.distance_m) >= last_m - kElsewhere_m;
}

PlaceGuess PlaceFinder::find(const FeatureSet& view) {
  const std::vector<Candidate> candidates = likeliest(view);
  if (candidates.empty() || !candidates.front().recognised ||
      candidates.front().confidence < kLeastConfidence) {
    return refused("the view was not recognised anywhere on the path");
  }
  Candidate best = candidates.front();
  const auto rival = std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& other) {
    return std::abs(other.map->distance_m - best.map->distance_m) > kElsewhere_m &&
           !endsOfALoop(*other.map, *best.map);
  });
  for (const Candidate& other :
       candidates) {  // of the ends of a loop the beginning, if it is about as likely
    const bool earlier = other.map->distance_m < best.map->distance_m - kElsewhere_m;
    if (earlier && endsOfALoop(*other.map, *best.map) &&
        other.inliers >= kAboutAsLikely * candidates.front().inliers) {
      best = other;
    }
  }
  const int rival_inliers = rival == candidates.end() ? 0 : rival->inliers;
  if (rival_inliers > kRivalShare * best.inliers) {
    return refused("ambiguous: it looks like " + humanMetres(best.map->distance_m) + " (" +
                   std::to_string(best.inliers) + " features agree), but like " +
                   humanMetres(rival->map->distance_m) + " (" + std::to_string(rival_inliers) + "), too");
  }
  PlaceGuess guess;
  guess.sure = true;
  guess.distance_m = best.map->distance_m;
  guess.index = best.map->index;
  guess.inliers = best.inliers;
  guess.certainty = best.confidence * (1.0 - static_cast<double>(rival_inliers) / best.inliers);
  guess.reason = "at " + humanMetres(guess.distance_m) + " of the path, " + std::to_string(best.inliers) +
                 " features agree, certainty " + humanNumber(100.0 * guess.certainty, "%");
  return guess;
}

}  // namespace perennial
