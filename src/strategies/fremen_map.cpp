#include "perennial/strategies/fremen_map.h"

#include <algorithm>

namespace perennial::strategies {

void FremenMap::configure(ParameterReader& reader) {
  settings_.model = FremenSettings::load(reader);
  settings_.scores = ScoreSettings::load(reader);
  settings_.exchange = ExchangeSettings::load(reader);
  settings_.features_used = reader.integer("features_used", settings_.features_used, 0, 1000000);
  settings_.features_kept = reader.integer("features_kept", settings_.features_kept, 0, 1000000);
  settings_.score_unknown = reader.real("score_unknown", settings_.score_unknown, -1000.0, 1000.0);
  model_ = FremenModel(settings_.model);
}

std::size_t FremenMap::maxFeatures(std::size_t taught, std::size_t /*seen*/) const {
  return std::max(taught, static_cast<std::size_t>(settings_.features_kept));
}

Alternatives FremenMap::alternatives(const LocalMap& map, double stamp_s) const {
  const FremenModel::Phases now = model_.phases(stamp_s - map.stamp_s);
  const bool known = readable(map);
  std::vector<double> predicted(map.size(), settings_.score_unknown);
  for (std::size_t i = 0; known && i < map.size(); ++i) {
    const double* state = map.featureNumbers(i);
    if (FremenModel::count(state) > 0.0) {
      predicted[i] = model_.predict(state, now);
    }
  }
  return {bestFeatures(map, predicted, static_cast<std::size_t>(settings_.features_used))};
}

void FremenMap::update(LocalMap& map, const Observation& observation) const {
  if (!readable(map)) {
    std::fill(map.numbers.begin(), map.numbers.end(), 0.0);
    map.map_numbers = model_.settings().periods_s;
  }
  sample(map, observation);
  exchange(map, observation);
}

void FremenMap::sample(LocalMap& map, const Observation& observation) const {
  const double time_s = observation.stamp_s - map.stamp_s;
  const FremenModel::Phases now = model_.phases(time_s);
  for (std::size_t k = 0; k < observation.used.size(); ++k) {
    model_.add(map.featureNumbers(observation.used[k]), time_s, now,
               settings_.scores.of(observation.registration.states[k]));
  }
}

void FremenMap::exchange(LocalMap& map, const Observation& observation) const {
  std::vector<std::size_t> incoming = newFeatures(map, observation, settings_.exchange.adding);
  incoming.resize(std::min(incoming.size(), settings_.exchange.countFor(map.size())));
  std::vector<double> scores(map.size());
  std::vector<bool> proven(map.size());
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double* state = map.featureNumbers(i);
    const bool known = FremenModel::count(state) > 0.0;
    scores[i] = known ? FremenModel::mean(state) : settings_.score_unknown;
    proven[i] = known && FremenModel::greatest(state) > 0.0;
  }
  exchangeFeatures(map, observation, worstFirst(map, scores, proven), incoming,
                   static_cast<std::size_t>(settings_.features_kept));
}

}  // namespace perennial::strategies
