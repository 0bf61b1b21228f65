#include "perennial/strategies/anchored_map.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace perennial::strategies {
namespace {

constexpr std::size_t kCohort = 0;
constexpr std::size_t kCohortVariance = 1;
constexpr std::size_t kOwnVariance = 2;
constexpr std::size_t kScore = 3;
constexpr std::size_t kTimesCorrect = 4;

// The map's own numbers.
constexpr std::size_t kCohorts = 0;
constexpr std::size_t kTaughtFeatures = 1;

constexpr double kTaught = 0.0;
constexpr std::size_t kEnoughToMove = 5;  ///< pairs that must agree before a cohort is put somewhere else

double square(double value) { return value * value; }

/// Of sorted values, the window of this width with the greatest sum of weights.
struct Window {
  std::size_t begin = 0;
  std::size_t end = 0;
  double weight = 0.0;
};

Window heaviestWindow(const std::vector<std::pair<double, double>>& value_and_weight, double width) {
  Window best;
  double weight = 0.0;
  std::size_t begin = 0;
  for (std::size_t end = 0; end < value_and_weight.size(); ++end) {
    weight += value_and_weight[end].second;
    for (; value_and_weight[end].first - value_and_weight[begin].first > width; ++begin) {
      weight -= value_and_weight[begin].second;
    }
    if (weight > best.weight + 1e-12) {
      best = {begin, end + 1, weight};
    }
  }
  return best;
}

double weightedMean(const std::vector<std::pair<double, double>>& value_and_weight, const Window& window) {
  double sum = 0.0;
  double weights = 0.0;
  for (std::size_t k = window.begin; k < window.end; ++k) {
    sum += value_and_weight[k].first * value_and_weight[k].second;
    weights += value_and_weight[k].second;
  }
  return sum / weights;
}

}  // namespace

/// A map feature and the view feature it was matched with, agreeing or not.
struct AnchoredMap::Pair {
  std::size_t feature = 0;  ///< position in the local map
  double cohort = 0.0;
  double cohort_variance = 0.0;
  double difference = 0.0;  ///< x_map - x_view
};

struct AnchoredMap::Estimate {
  double displacement_px = 0.0;
  double variance = 0.0;
  double lead = 0.0;  ///< its support by that of the best displacement elsewhere
};

void AnchoredMap::configure(ParameterReader& reader) {
  settings_.scores = ScoreSettings::load(reader);
  settings_.adding = AddSettings::load(reader);
  settings_.share = reader.real("share", settings_.share, 0.0, 1.0);
  settings_.features_kept = reader.integer("features_kept", settings_.features_kept, 1, 1000000);
  settings_.features_used = reader.integer("features_used", settings_.features_used, 0, 1000000);
  settings_.taught_share = reader.real("taught_share", settings_.taught_share, 0.0, 1.0);
  settings_.feature_noise_px = reader.real("feature_noise_px", settings_.feature_noise_px, 0.01, 1000.0);
  settings_.cohort_noise_px = reader.real("cohort_noise_px", settings_.cohort_noise_px, 0.01, 1000.0);
  settings_.reach_px = reader.real("reach_px", settings_.reach_px, 0.1, 10000.0);
  settings_.min_lead = reader.real("min_lead", settings_.min_lead, 0.0, 1000.0);
}

std::size_t AnchoredMap::maxFeatures(std::size_t taught, std::size_t /*seen*/) const {
  return std::max(taught, static_cast<std::size_t>(settings_.features_kept));
}

Alternatives AnchoredMap::alternatives(const LocalMap& map, double /*stamp_s*/) const {
  std::vector<double> scores(map.size());
  for (std::size_t i = 0; i < map.size(); ++i) {
    scores[i] = map.featureNumbers(i)[kScore];
  }
  return {bestFeatures(map, scores, static_cast<std::size_t>(settings_.features_used))};
}

void AnchoredMap::update(LocalMap& map, const Observation& observation) const {
  if (map.map_numbers.empty()) {
    map.map_numbers = {0.0, static_cast<double>(map.size())};
  }
  std::vector<Pair> pairs;
  for (std::size_t k = 0; k < observation.used.size(); ++k) {
    const std::int32_t partner = observation.registration.partners[k];
    if (partner >= 0) {
      const std::size_t i = observation.used[k];
      const double* numbers = map.featureNumbers(i);
      const double x_view = observation.view.keypoints[static_cast<std::size_t>(partner)].x;
      pairs.push_back({i, numbers[kCohort], numbers[kCohortVariance], map.features.keypoints[i].x - x_view});
    }
  }
  if (pairs.empty()) {
    return;  // nothing ties this view to the map
  }
  const Estimate found = estimate(pairs);
  score(map, pairs, observation, found);
  correct(map, pairs, found);
  exchange(map, observation, found);
}

AnchoredMap::Estimate AnchoredMap::estimate(const std::vector<Pair>& pairs) const {
  // A cohort of n pairs weighs 1 / (noise^2 / n + C) in all, however many they are: its common error does not
  // average.
  const double noise = square(settings_.feature_noise_px);
  std::map<double, double> cohort_sizes;
  for (const Pair& pair : pairs) {
    cohort_sizes[pair.cohort] += 1.0;
  }
  std::vector<std::pair<double, double>> votes;
  votes.reserve(pairs.size());
  for (const Pair& pair : pairs) {
    votes.emplace_back(pair.difference, 1.0 / (noise + cohort_sizes[pair.cohort] * pair.cohort_variance));
  }
  std::sort(votes.begin(), votes.end());
  const Window best = heaviestWindow(votes, 2.0 * settings_.reach_px);
  Estimate result;
  result.displacement_px = weightedMean(votes, best);

  double information = 0.0;
  std::vector<std::pair<double, double>> elsewhere;
  for (const auto& vote : votes) {
    if (std::abs(vote.first - result.displacement_px) <= settings_.reach_px) {
      information += vote.second;
    } else {
      elsewhere.push_back(vote);
    }
  }
  information = std::max(information, best.weight / 2.0);
  result.variance = 1.0 / information;
  const double other = heaviestWindow(elsewhere, 2.0 * settings_.reach_px).weight;
  result.lead = other > 0.0 ? information / other : settings_.min_lead;
  return result;
}

void AnchoredMap::correct(LocalMap& map, const std::vector<Pair>& pairs, const Estimate& estimate) const {
  const double noise = square(settings_.feature_noise_px);
  std::map<double, std::vector<std::pair<double, double>>> differences;  // of each late cohort
  std::map<double, double> variances;
  for (const Pair& pair : pairs) {
    if (pair.cohort != kTaught) {
      differences[pair.cohort].emplace_back(pair.difference, 1.0);
      variances[pair.cohort] = pair.cohort_variance;
    }
  }
  std::map<double, double> shifts;
  for (auto& [cohort, values] : differences) {
    std::sort(values.begin(), values.end());
    const Window agreed = heaviestWindow(values, 2.0 * settings_.reach_px);
    const double innovation = weightedMean(values, agreed) - estimate.displacement_px;
    const double measured = noise / agreed.weight + estimate.variance;
    double& variance = variances[cohort];
    double gain = variance / (variance + measured);
    if (std::abs(innovation) > settings_.reach_px) {
      const bool sure = agreed.end - agreed.begin >= kEnoughToMove && estimate.lead >= settings_.min_lead;
      gain = sure ? 1.0 : 0.0;  // it was put in the wrong place, or these pairs are wrong
      variance = sure ? measured : variance;
    } else {
      variance *= 1.0 - gain;
    }
    shifts[cohort] = -gain * innovation;
  }
  for (std::size_t i = 0; i < map.size(); ++i) {
    double* numbers = map.featureNumbers(i);
    const auto shift = shifts.find(numbers[kCohort]);
    if (shift != shifts.end()) {
      float& x = map.features.keypoints[i].x;
      x = static_cast<float>(x + shift->second);
      numbers[kCohortVariance] = variances[numbers[kCohort]];
    }
  }
  for (const Pair& pair : pairs) {
    double& own = map.featureNumbers(pair.feature)[kOwnVariance];
    const auto shift = shifts.find(pair.cohort);
    const double residual =
        pair.difference + (shift == shifts.end() ? 0.0 : shift->second) - estimate.displacement_px;
    if (pair.cohort != kTaught && std::abs(residual) <= settings_.reach_px) {
      const double gain = own / (own + noise + estimate.variance);
      float& x = map.features.keypoints[pair.feature].x;
      x = static_cast<float>(x - gain * residual);
      own *= 1.0 - gain;
    }
  }
}

void AnchoredMap::score(LocalMap& map, const std::vector<Pair>& pairs, const Observation& observation,
                        const Estimate& estimate) const {
  for (const std::size_t i : featuresIn(observation, FeatureState::kNotMatched)) {
    map.featureNumbers(i)[kScore] += settings_.scores.of(FeatureState::kNotMatched);
  }
  for (const Pair& pair : pairs) {
    const bool correct = std::abs(pair.difference - estimate.displacement_px) <= settings_.reach_px;
    double* numbers = map.featureNumbers(pair.feature);
    numbers[kScore] +=
        settings_.scores.of(correct ? FeatureState::kMatchedCorrectly : FeatureState::kMatchedIncorrectly);
    numbers[kTimesCorrect] += correct ? 1.0 : 0.0;
  }
}

std::vector<std::size_t> AnchoredMap::dispensableFirst(const LocalMap& map) const {
  std::vector<double> scores(map.size());
  std::vector<bool> proven(map.size());
  std::size_t taught = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    scores[i] = map.featureNumbers(i)[kScore];
    proven[i] = map.featureNumbers(i)[kTimesCorrect] > 0.0;
    taught += map.featureNumbers(i)[kCohort] == kTaught ? 1 : 0;
  }
  const auto frame =
      static_cast<std::size_t>(std::ceil(settings_.taught_share * map.map_numbers[kTaughtFeatures]));
  std::size_t taught_to_spare = taught > frame ? taught - frame : 0;
  std::vector<std::size_t> result;
  for (const std::size_t i : worstFirst(map, scores, proven)) {
    const bool is_taught = map.featureNumbers(i)[kCohort] == kTaught;
    if (is_taught && taught_to_spare == 0) {
      continue;
    }
    taught_to_spare -= is_taught ? 1 : 0;
    result.push_back(i);
  }
  return result;
}

void AnchoredMap::exchange(LocalMap& map, const Observation& observation, const Estimate& estimate) const {
  if (estimate.lead < settings_.min_lead) {
    return;
  }
  std::vector<std::size_t> incoming = newFeatures(map, observation, settings_.adding);
  const auto wanted =
      static_cast<std::size_t>(std::lround(settings_.share * static_cast<double>(observation.view.size())));
  incoming.resize(std::min(incoming.size(), wanted));

  Observation placed = observation;
  placed.registration.displacement_px = estimate.displacement_px;
  const std::uint32_t first_new = map.next_id;
  exchangeFeatures(map, placed, dispensableFirst(map), incoming,
                   static_cast<std::size_t>(settings_.features_kept));
  map.map_numbers[kCohorts] += 1.0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.ids[i] >= first_new) {
      double* numbers = map.featureNumbers(i);
      numbers[kCohort] = map.map_numbers[kCohorts];
      numbers[kCohortVariance] = estimate.variance + square(settings_.cohort_noise_px);
      numbers[kOwnVariance] = square(settings_.feature_noise_px);
    }
  }
}

}  // namespace perennial::strategies
