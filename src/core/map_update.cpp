#include "perennial/core/map_update.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <random>
#include <tuple>
#include <utility>

#include "core/registration/descriptor_table.h"
#include "core/simd/kernels.h"

namespace perennial {
namespace {

std::vector<std::size_t> unpaired(const Observation& observation) {
  std::vector<bool> paired(observation.view.size(), false);
  for (const std::int32_t partner : observation.registration.partners) {
    if (partner >= 0) {
      paired[static_cast<std::size_t>(partner)] = true;
    }
  }
  std::vector<std::size_t> result;
  for (std::size_t j = 0; j < paired.size(); ++j) {
    if (!paired[j]) {
      result.push_back(j);
    }
  }
  return result;
}

void sortLeastAlikeFirst(std::vector<std::size_t>& candidates, const LocalMap& map, const FeatureSet& view) {
  DescriptorTable table;
  table.resize(map.size());
  for (std::size_t i = 0; i < map.size(); ++i) {
    table.set(i, map.features.descriptors[i]);
  }
  std::vector<std::uint16_t> distances(map.size());
  std::vector<int> distance(view.size(), Descriptor::kBits + 1);  // to the nearest in the map
  for (const std::size_t j : candidates) {
    kernels().hamming_distances(view.descriptors[j], table, 0, map.size(), distances.data());
    if (!distances.empty()) {
      distance[j] = *std::min_element(distances.begin(), distances.end());
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [&](std::size_t a, std::size_t b) { return distance[a] > distance[b]; });
}

/// Fisher and Yates' shuffle, on mt19937 alone: std::shuffle and the standard distributions differ between
/// libraries.
void shuffle(std::vector<std::size_t>& candidates, const LocalMap& map, double stamp_s) {
  std::uint64_t stamp_bits = 0;
  std::memcpy(&stamp_bits, &stamp_s, sizeof(stamp_bits));
  std::seed_seq seed{map.index, map.next_id, static_cast<std::uint32_t>(stamp_bits),
                     static_cast<std::uint32_t>(stamp_bits >> 32)};
  std::mt19937 random(seed);
  for (std::size_t left = candidates.size(); left > 1; --left) {
    std::swap(candidates[left - 1],
              candidates[static_cast<std::size_t>((std::uint64_t{random()} * left) >> 32)]);
  }
}

}  // namespace

AddSettings AddSettings::load(ParameterReader& reader) {
  AddSettings settings;
  settings.random_add = reader.boolean("random_add", settings.random_add);
  return settings;
}

ExchangeSettings ExchangeSettings::load(ParameterReader& reader, double default_exchange) {
  ExchangeSettings settings;
  settings.exchange = reader.real("exchange", default_exchange, 0.0, 1.0);
  settings.exchange_count = reader.integer("exchange_count", settings.exchange_count, 0, 1000000);
  settings.adding = AddSettings::load(reader);
  return settings;
}

std::size_t ExchangeSettings::countFor(std::size_t features) const {
  if (exchange_count > 0) {
    return static_cast<std::size_t>(exchange_count);
  }
  return static_cast<std::size_t>(std::lround(exchange * static_cast<double>(features)));
}

std::vector<std::size_t> newFeatures(const LocalMap& map, const Observation& observation,
                                     const AddSettings& settings) {
  std::vector<std::size_t> candidates = unpaired(observation);
  if (settings.random_add) {
    shuffle(candidates, map, observation.stamp_s);
  } else {
    sortLeastAlikeFirst(candidates, map, observation.view);
  }
  return candidates;
}

void insertFromView(LocalMap& map, const Observation& observation,
                    const std::vector<std::size_t>& view_indices) {
  const double displacement = observation.registration.displacement_px.value();
  for (const std::size_t j : view_indices) {
    Keypoint keypoint = observation.view.keypoints[j];
    keypoint.x = static_cast<float>(keypoint.x + displacement);
    map.add(keypoint, observation.view.descriptors[j]);
  }
}

void exchangeFeatures(LocalMap& map, const Observation& observation,
                      const std::vector<std::size_t>& drop_order, std::vector<std::size_t> incoming,
                      std::size_t capacity) {
  const std::size_t room = capacity > map.size() ? capacity - map.size() : 0;
  incoming.resize(std::min(incoming.size(), room + drop_order.size()));
  const std::size_t dropped = incoming.size() > room ? incoming.size() - room : 0;
  std::vector<bool> drop(map.size(), false);
  for (std::size_t k = 0; k < dropped; ++k) {
    drop[drop_order[k]] = true;
  }
  map.erase(drop);
  insertFromView(map, observation, incoming);
}

std::vector<std::size_t> featuresIn(const Observation& observation, FeatureState state) {
  std::vector<std::size_t> positions;
  for (std::size_t k = 0; k < observation.used.size(); ++k) {
    if (observation.registration.states[k] == state) {
      positions.push_back(observation.used[k]);
    }
  }
  return positions;
}

std::vector<std::size_t> worstFirst(const LocalMap& map, const std::vector<double>& scores,
                                    const std::vector<bool>& proven) {
  std::vector<std::size_t> order(map.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto rank = [&](std::size_t i) { return std::make_tuple(scores[i], bool{proven[i]}, map.ids[i]); };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  return order;
}

std::vector<std::size_t> bestFeatures(const LocalMap& map, const std::vector<double>& scores,
                                      std::size_t count) {
  std::vector<std::size_t> order(map.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (count == 0 || count >= order.size()) {
    return order;
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::make_tuple(scores[a], map.ids[a]) > std::make_tuple(scores[b], map.ids[b]);
  });
  order.resize(count);
  std::sort(order.begin(), order.end());
  return order;
}

}  // namespace perennial
