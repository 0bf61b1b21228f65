#include "perennial/core/place_finder.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "perennial/core/human_text.h"

namespace perennial {
namespace {

/// Features of the view that every local map is asked about.
constexpr std::size_t kStrongest = 100;
/// Local maps that follow each other look alike: of each stretch of this length a few stand for all, or those
/// of one place would leave no room for another.
constexpr double kStretch_m = 1.0;
constexpr std::size_t kMapsOfAStretch = 5;
/// Stretches that the whole view is compared with.
constexpr std::size_t kStretches = 24;
/// Share of the winner's pairs from which the other end of a loop is about as likely.
constexpr double kAboutAsLikely = 0.8;

FeatureSet strongestOf(const FeatureSet& view) {
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

std::string agreeing(int features) { return std::to_string(features) + " features agree"; }

}  // namespace

LocalisationSettings LocalisationSettings::load(ParameterReader& reader) {
  LocalisationSettings settings;
  settings.min_confidence = reader.real("min_confidence", settings.min_confidence, 0.0, 1.0);
  settings.rival_share = reader.real("rival_share", settings.rival_share, 0.0, 1.0);
  settings.elsewhere_m = reader.real("elsewhere_m", settings.elsewhere_m, 0.1, 1e3);
  settings.agreeing_images = reader.integer("agreeing_images", settings.agreeing_images, 1, 100);
  settings.agreement_m = reader.real("agreement_m", settings.agreement_m, 0.01, 1e3);
  settings.loop = reader.boolean("loop", settings.loop);
  return settings;
}

PlaceFinder::PlaceFinder(const LocalisationSettings& settings, const RegistrationSettings& registration)
    : settings_(settings), registration_(makeRegistration(registration)) {}

void PlaceFinder::seek(FeatureSet view) {
  view_ = std::move(view);
  strongest_ = strongestOf(view_);
  stretches_.clear();
  open_ = {};
  considered_ = 0;
}

void PlaceFinder::consider(std::shared_ptr<const ActiveMap> map) {
  last_m_ = map->distance_m;
  if (considered_++ == 0) {
    first_m_ = map->distance_m;
  }
  if (!open_.members.empty() && map->distance_m >= open_.begin_m + kStretch_m) {
    closeStretch();
  }
  if (open_.members.empty()) {
    open_.begin_m = map->distance_m;
  }
  const int inliers = judgeRoughly(*map);
  open_.inliers = std::max(open_.inliers, inliers);
  open_.members.push_back({std::move(map), inliers});
  if (open_.members.size() > kMapsOfAStretch) {
    open_.members.erase(std::min_element(open_.members.begin(), open_.members.end(),
                                         [](const auto& a, const auto& b) { return a.inliers < b.inliers; }));
  }
}

void PlaceFinder::closeStretch() {
  stretches_.push_back(std::exchange(open_, {}));
  if (stretches_.size() > kStretches) {
    stretches_.erase(std::min_element(stretches_.begin(), stretches_.end(),
                                      [](const auto& a, const auto& b) { return a.inliers < b.inliers; }));
  }
}

int PlaceFinder::judgeRoughly(const ActiveMap& map) {
  registerInto(*registration_, map, strongest_, workspace_, result_);
  return result_.result.inliers;
}

PlaceFinder::Candidate PlaceFinder::judge(const ActiveMap& map) {
  registerInto(*registration_, map, view_, workspace_, result_);
  const RegistrationResult& result = result_.result;
  return {map.distance_m, map.index, result.inliers, result.confidence, result.displacement_px.has_value()};
}

std::vector<PlaceFinder::Candidate> PlaceFinder::likeliest() {
  closeStretch();
  std::vector<Candidate> candidates;
  for (const Stretch& stretch : stretches_) {
    for (const Stretch::Member& member : stretch.members) {
      candidates.push_back(judge(*member.map));
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.inliers > b.inliers; });
  return candidates;
}

/// Whether they would be near to each other if the path were closed.
bool PlaceFinder::acrossTheEnds(const Candidate& a, const Candidate& b) const {
  return last_m_ - first_m_ - std::abs(a.distance_m - b.distance_m) <= settings_.elsewhere_m;
}

/// Whether they are near to each other, straight along the path or across the ends of a loop.
bool PlaceFinder::samePlace(const Candidate& a, const Candidate& b) const {
  return std::abs(a.distance_m - b.distance_m) <= settings_.elsewhere_m ||
         (settings_.loop && acrossTheEnds(a, b));
}

/// The likeliest candidate; but if that lies at the end of a loop, the one at its beginning when that is
/// about as likely.
PlaceFinder::Candidate PlaceFinder::beginningOfLoop(const std::vector<Candidate>& candidates) const {
  const Candidate& best = candidates.front();
  const auto beginning = std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& other) {
    return other.distance_m < best.distance_m - settings_.elsewhere_m && samePlace(other, best) &&
           other.inliers >= kAboutAsLikely * best.inliers;
  });
  return beginning == candidates.end() ? best : *beginning;
}

PlaceGuess PlaceFinder::ambiguous(const Candidate& best, const Candidate& rival) const {
  const std::string advice =
      settings_.loop || !acrossTheEnds(best, rival)
          ? ""
          : "; these are the ends of the path: if it is closed, localisation/loop: true "
            "takes the beginning";
  return refused("ambiguous: the view looks like " + humanMetres(best.distance_m) + " of the path (" +
                 agreeing(best.inliers) + "), but like " + humanMetres(rival.distance_m) + " (" +
                 std::to_string(rival.inliers) + "), too" + advice);
}

PlaceGuess PlaceFinder::guess() {
  const std::vector<Candidate> candidates = likeliest();
  if (candidates.empty() || !candidates.front().recognised ||
      candidates.front().confidence < settings_.min_confidence) {
    return refused("the view was not recognised anywhere on the path");
  }
  const Candidate best = beginningOfLoop(candidates);
  const auto rival = std::find_if(candidates.begin(), candidates.end(),
                                  [&](const Candidate& other) { return !samePlace(other, best); });
  const int rival_inliers = rival == candidates.end() ? 0 : rival->inliers;
  if (rival_inliers > settings_.rival_share * best.inliers) {
    return ambiguous(best, *rival);
  }
  PlaceGuess guess;
  guess.sure = true;
  guess.distance_m = best.distance_m;
  guess.index = best.index;
  guess.inliers = best.inliers;
  guess.certainty = best.confidence * (1.0 - static_cast<double>(rival_inliers) / best.inliers);
  guess.reason = "at " + humanMetres(guess.distance_m) + " of the path, " + agreeing(best.inliers);
  return guess;
}

}  // namespace perennial
