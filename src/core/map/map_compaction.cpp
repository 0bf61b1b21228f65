#include "core/map/map_compaction.h"

#include <algorithm>
#include <vector>

namespace perennial {
namespace {

/// Traversals up to `last_merged` become one.
struct Numbering {
  std::uint32_t last_merged = 0;

  std::uint32_t operator()(std::uint32_t traversal) const {
    const std::uint32_t dropped = last_merged > 0 ? last_merged - 1 : 0;
    return traversal > last_merged ? traversal - dropped : std::min<std::uint32_t>(traversal, 1);
  }
};

void copyPlaceAndImage(const Database& source, std::uint32_t index, const Database& target) {
  const Place place = readPlace(source, index);
  Statement(target, "INSERT INTO local_map VALUES(?, ?, ?, ?)")
      .bind(0, std::int64_t{index})
      .bind(1, place.distance_m)
      .bind(2, place.stamp_s)
      .bind(3, std::int64_t{placeChecksum(index, place.distance_m, place.stamp_s)})
      .run();
  const Bytes png = readPng(source, index);
  Statement(target, "INSERT INTO image VALUES(?, ?, ?)")
      .bind(0, std::int64_t{index})
      .bind(1, png)
      .bind(2, std::int64_t{imageChecksum(index, png)})
      .run();
}

void copyState(const Database& source, std::uint32_t index, std::uint32_t traversal, std::uint32_t number,
               const Database& target) {
  const Bytes features = encodeLocalMap(readState(source, index, traversal));
  Statement(target, "INSERT INTO state VALUES(NULL, ?, ?, ?, ?)")
      .bind(0, std::int64_t{index})
      .bind(1, std::int64_t{number})
      .bind(2, features)
      .bind(3, std::int64_t{stateChecksum(index, number, features)})
      .run();
}

/// Of the states that become one, the newest counts. Counts in `updated` what each traversal changes.
void copyStates(const Database& source, std::uint32_t index, const Numbering& numbering,
                const Database& target, std::vector<std::size_t>& updated) {
  Statement query(source, "SELECT traversal FROM state WHERE local_map = ? ORDER BY traversal");
  query.bind(0, std::int64_t{index});
  std::vector<std::uint32_t> traversals;
  while (query.step()) {
    traversals.push_back(unsigned32(query, 0));
  }
  for (std::size_t i = 0; i < traversals.size(); ++i) {
    const std::uint32_t number = numbering(traversals[i]);
    const bool superseded = i + 1 < traversals.size() && numbering(traversals[i + 1]) == number;
    if (!superseded) {
      copyState(source, index, traversals[i], number, target);
      ++updated.at(number);
    }
  }
}

/// The merged one begins with the first and ends with the last of those that it stands for.
std::vector<TraversalInfo> renumbered(const std::vector<TraversalInfo>& traversals,
                                      const Numbering& numbering) {
  std::vector<TraversalInfo> result;
  for (const TraversalInfo& traversal : traversals) {
    const std::uint32_t number = numbering(traversal.id);
    if (number == result.size()) {
      result.push_back(traversal);
      result.back().id = number;
    } else {
      result.back().strategy = traversal.strategy;
      result.back().end_stamp_s = traversal.end_stamp_s;
    }
  }
  return result;
}

}  // namespace

void copyCompacted(const Database& source, const StoredMetadata& stored, std::uint32_t keep,
                   const Database& target) {
  const std::vector<TraversalInfo> traversals = readTraversals(source);
  const auto newest = static_cast<std::uint32_t>(traversals.size() - 1);
  const Numbering numbering{newest > keep ? newest - keep : 0};
  std::vector<TraversalInfo> kept = renumbered(traversals, numbering);
  std::vector<std::size_t> updated(kept.size(), 0);
  for (std::uint32_t index = 0; index < stored.local_maps; ++index) {
    copyPlaceAndImage(source, index, target);
    copyStates(source, index, numbering, target, updated);
  }
  for (TraversalInfo& traversal : kept) {
    traversal.updated_maps = updated[traversal.id];
    writeTraversal(target, traversal);
  }
  writeProfile(target, readProfile(source, stored.profile_entries));
  writeMetadata(target, stored);
}

}  // namespace perennial
