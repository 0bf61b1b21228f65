#include "perennial/strategies/score_based.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

#include "perennial/core/map_update.h"

namespace perennial::strategies {
namespace {

constexpr std::size_t kScore = 0;
constexpr std::size_t kTimesCorrect = 1;

}  // namespace

void ScoreBased::configure(ParameterReader& reader) {
  settings_.exchange = reader.real("exchange", settings_.exchange, 0.0, 1.0);
  settings_.score_correct = reader.real("score_correct", settings_.score_correct, 0.0, 1000.0);
  settings_.score_incorrect = reader.real("score_incorrect", settings_.score_incorrect, 0.0, 1000.0);
  settings_.score_not_matched = reader.real("score_not_matched", settings_.score_not_matched, 0.0, 1000.0);
}

void ScoreBased::update(LocalMap& map, const Observation& observation) const {
  score(map, observation);
  exchange(map, observation);
}

void ScoreBased::score(LocalMap& map, const Observation& observation) const {
  for (std::size_t k = 0; k < observation.used.size(); ++k) {
    double* numbers = map.featureNumbers(observation.used[k]);
    switch (observation.registration.states[k]) {
      case FeatureState::kMatchedCorrectly:
        numbers[kScore] += settings_.score_correct;
        numbers[kTimesCorrect] += 1.0;
        break;
      case FeatureState::kMatchedIncorrectly:
        numbers[kScore] -= settings_.score_incorrect;
        break;
      case FeatureState::kNotMatched:
        numbers[kScore] -= settings_.score_not_matched;
        break;
    }
  }
}

void ScoreBased::exchange(LocalMap& map, const Observation& observation) const {
  std::vector<std::size_t> incoming = newFeatures(map, observation);
  const auto wanted = static_cast<std::size_t>(std::lround(settings_.exchange * static_cast<double>(map.size())));
  incoming.resize(std::min(incoming.size(), wanted));  // never drop what cannot be replaced

  std::vector<std::size_t> worst_first(map.size());
  std::iota(worst_first.begin(), worst_first.end(), std::size_t{0});
  const auto rank = [&](std::size_t i) {
    const double* numbers = map.featureNumbers(i);
    return std::make_tuple(numbers[kScore], numbers[kTimesCorrect] > 0.0, map.ids[i]);
  };
  std::sort(worst_first.begin(), worst_first.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });

  std::vector<bool> drop(map.size(), false);
  for (std::size_t k = 0; k < incoming.size(); ++k) {
    drop[worst_first[k]] = true;
  }
  map.erase(drop);
  insertFromView(map, observation, incoming);
}

}  // namespace perennial::strategies
