#include "perennial/strategies/score_based.h"

#include <algorithm>
#include <vector>

namespace perennial::strategies {
namespace {

constexpr std::size_t kScore = 0;
constexpr std::size_t kTimesCorrect = 1;

std::vector<double> scoresOf(const LocalMap& map) {
  std::vector<double> scores(map.size());
  for (std::size_t i = 0; i < map.size(); ++i) {
    scores[i] = map.featureNumbers(i)[kScore];
  }
  return scores;
}

}  // namespace

ScoreSettings ScoreSettings::load(ParameterReader& reader) {
  ScoreSettings settings;
  settings.score_correct = reader.real("score_correct", settings.score_correct, 0.0, 1000.0);
  settings.score_incorrect = reader.real("score_incorrect", settings.score_incorrect, 0.0, 1000.0);
  settings.score_not_matched = reader.real("score_not_matched", settings.score_not_matched, 0.0, 1000.0);
  return settings;
}

double ScoreSettings::of(FeatureState state) const {
  switch (state) {
    case FeatureState::kMatchedCorrectly:
      return score_correct;
    case FeatureState::kMatchedIncorrectly:
      return -score_incorrect;
    case FeatureState::kNotMatched:
      break;
  }
  return -score_not_matched;
}

void ScoreBased::configure(ParameterReader& reader) {
  settings_.scores = ScoreSettings::load(reader);
  settings_.exchange = ExchangeSettings::load(reader);
  settings_.features_used = reader.integer("features_used", settings_.features_used, 0, 1000000);
  settings_.features_kept = reader.integer("features_kept", settings_.features_kept, 0, 1000000);
}

std::size_t ScoreBased::maxFeatures(std::size_t taught, std::size_t /*seen*/) const {
  return std::max(taught, static_cast<std::size_t>(settings_.features_kept));
}

Alternatives ScoreBased::alternatives(const LocalMap& map, double /*stamp_s*/) const {
  return {bestFeatures(map, scoresOf(map), static_cast<std::size_t>(settings_.features_used))};
}

void ScoreBased::update(LocalMap& map, const Observation& observation) const {
  score(map, observation);
  exchange(map, observation);
}

void ScoreBased::score(LocalMap& map, const Observation& observation) const {
  for (std::size_t k = 0; k < observation.used.size(); ++k) {
    const FeatureState state = observation.registration.states[k];
    double* numbers = map.featureNumbers(observation.used[k]);
    numbers[kScore] += settings_.scores.of(state);
    numbers[kTimesCorrect] += state == FeatureState::kMatchedCorrectly ? 1.0 : 0.0;
  }
}

void ScoreBased::exchange(LocalMap& map, const Observation& observation) const {
  std::vector<std::size_t> incoming = newFeatures(map, observation, settings_.exchange.adding);
  incoming.resize(std::min(incoming.size(), settings_.exchange.countFor(map.size())));
  std::vector<bool> proven(map.size());
  for (std::size_t i = 0; i < map.size(); ++i) {
    proven[i] = map.featureNumbers(i)[kTimesCorrect] > 0.0;
  }
  exchangeFeatures(map, observation, worstFirst(map, scoresOf(map), proven), incoming,
                   static_cast<std::size_t>(settings_.features_kept));
}

}  // namespace perennial::strategies
