#include "core/map/map_rows.h"

#include <limits>

#include "core/map/row_checksum.h"

namespace perennial {
namespace {

std::string numbered(const char* what, std::uint32_t number) { return what + std::to_string(number); }

std::uint32_t profileChecksum(std::uint32_t number, const ProfileEntry& entry) {
  return RowChecksum()
      .add(number)
      .add(entry.distance_m)
      .add(entry.velocity.forward)
      .add(entry.velocity.angular)
      .add(entry.velocity.flipper)
      .value();
}

std::uint32_t traversalChecksum(const TraversalInfo& traversal) {
  return RowChecksum()
      .add(traversal.id)
      .add(traversal.strategy)
      .add(traversal.start_stamp_s)
      .add(traversal.end_stamp_s)
      .add(static_cast<std::uint32_t>(traversal.updated_maps))
      .value();
}

}  // namespace

void throwDamaged(const std::string& file, const std::string& what) {
  throw MapError(
      "map '" + file + "' is damaged: " + what +
      ". `map_tool verify` lists all damage; restore the file from a copy, or teach the path again");
}

std::uint32_t unsigned32(const Statement& row, int column) {
  const std::int64_t value = row.integer(column);
  const bool valid =
      row.type(column) == SQLITE_INTEGER && value >= 0 && value <= std::numeric_limits<std::uint32_t>::max();
  return valid ? static_cast<std::uint32_t>(value) : std::numeric_limits<std::uint32_t>::max();
}

std::uint32_t placeChecksum(std::uint32_t local_map, double distance_m, double stamp_s) {
  return RowChecksum().add(local_map).add(distance_m).add(stamp_s).value();
}

std::uint32_t imageChecksum(std::uint32_t local_map, const Bytes& png) {
  return RowChecksum().add(local_map).addBytes(png.data(), png.size()).value();
}

std::uint32_t stateChecksum(std::uint32_t local_map, std::uint32_t traversal, const Bytes& features) {
  return RowChecksum().add(local_map).add(traversal).addBytes(features.data(), features.size()).value();
}

void writeProfile(const Database& database, const PathProfile& profile) {
  Statement insert(database, "INSERT INTO profile VALUES(?, ?, ?, ?, ?, ?)");
  std::uint32_t number = 0;
  for (const ProfileEntry& entry : profile.entries()) {
    insert.bind(0, std::int64_t{number}).bind(1, entry.distance_m).bind(2, entry.velocity.forward);
    insert.bind(3, entry.velocity.angular).bind(4, entry.velocity.flipper);
    insert.bind(5, std::int64_t{profileChecksum(number, entry)});
    insert.run();
    ++number;
  }
}

PathProfile readProfile(const Database& database, std::size_t entries) {
  Statement query(database,
                  "SELECT entry, distance_m, forward, angular, flipper, crc FROM profile ORDER BY entry");
  std::vector<ProfileEntry> found;
  while (query.step()) {
    const auto number = static_cast<std::uint32_t>(found.size());
    const ProfileEntry entry{query.real(1), {query.real(2), query.real(3), query.real(4)}};
    if (unsigned32(query, 0) != number || unsigned32(query, 5) != profileChecksum(number, entry)) {
      throwDamaged(database.file(), numbered("the checksum of profile entry ", number) + " is wrong");
    }
    found.push_back(entry);
  }
  if (found.size() != entries) {
    throwDamaged(database.file(), "its profile has " + std::to_string(found.size()) + " entries instead of " +
                                      std::to_string(entries));
  }
  try {
    return PathProfile::fromEntries(std::move(found));
  } catch (const Error& error) {
    throwDamaged(database.file(), error.what());
  }
}

void writeTraversal(const Database& database, const TraversalInfo& traversal) {
  Statement insert(database, "INSERT INTO traversal VALUES(?, ?, ?, ?, ?, ?)");
  insert.bind(0, std::int64_t{traversal.id}).bind(1, traversal.strategy);
  insert.bind(2, traversal.start_stamp_s).bind(3, traversal.end_stamp_s);
  insert.bind(4, static_cast<std::int64_t>(traversal.updated_maps));
  insert.bind(5, std::int64_t{traversalChecksum(traversal)}).run();
}

std::vector<TraversalInfo> readTraversals(const Database& database) {
  Statement query(database,
                  "SELECT traversal, strategy, start_stamp_s, end_stamp_s, updated_maps, crc FROM traversal "
                  "ORDER BY traversal");
  std::vector<TraversalInfo> traversals;
  while (query.step()) {
    const TraversalInfo traversal{unsigned32(query, 0), query.text(1), query.real(2), query.real(3),
                                  unsigned32(query, 4)};
    if (traversal.id != traversals.size() || unsigned32(query, 5) != traversalChecksum(traversal)) {
      throwDamaged(database.file(), numbered("the checksum of traversal ", traversal.id) + " is wrong");
    }
    traversals.push_back(traversal);
  }
  if (traversals.empty()) {
    throwDamaged(database.file(), "the record of its teaching is missing");
  }
  return traversals;
}

Place readPlace(const Database& database, std::uint32_t local_map) {
  Statement query(database, "SELECT distance_m, stamp_s, crc FROM local_map WHERE local_map = ?");
  query.bind(0, std::int64_t{local_map});
  if (!query.step()) {
    throwDamaged(database.file(), numbered("local map ", local_map) + " is missing");
  }
  const Place place{query.real(0), query.real(1)};
  if (unsigned32(query, 2) != placeChecksum(local_map, place.distance_m, place.stamp_s)) {
    throwDamaged(database.file(),
                 numbered("the checksum of the place of local map ", local_map) + " is wrong");
  }
  return place;
}

LocalMap readState(const Database& database, std::uint32_t local_map, std::uint32_t traversal) {
  Statement query(database,
                  "SELECT traversal, features, crc FROM state WHERE local_map = ? AND traversal <= ? "
                  "ORDER BY traversal DESC LIMIT 1");
  query.bind(0, std::int64_t{local_map}).bind(1, std::int64_t{traversal});
  if (!query.step()) {
    throwDamaged(database.file(), numbered("the features of local map ", local_map) + " are missing");
  }
  const std::string name =
      numbered("local map ", local_map) + numbered(" after traversal ", unsigned32(query, 0));
  const Bytes features = query.blob(1);
  if (unsigned32(query, 2) != stateChecksum(local_map, unsigned32(query, 0), features)) {
    throwDamaged(database.file(), "the checksum of " + name + " is wrong");
  }
  try {
    LocalMap map = decodeLocalMap(features);
    if (map.index == local_map) {
      return map;
    }
  } catch (const MapError& error) {
    throwDamaged(database.file(), name + ": " + error.what());
  }
  throwDamaged(database.file(), name + " holds another local map");
}

Bytes readPng(const Database& database, std::uint32_t local_map) {
  Statement query(database, "SELECT png, crc FROM image WHERE local_map = ?");
  query.bind(0, std::int64_t{local_map});
  if (!query.step()) {
    throwDamaged(database.file(), numbered("the image of local map ", local_map) + " is missing");
  }
  Bytes png = query.blob(0);
  if (unsigned32(query, 1) != imageChecksum(local_map, png)) {
    throwDamaged(database.file(),
                 numbered("the checksum of the image of local map ", local_map) + " is wrong");
  }
  return png;
}

}  // namespace perennial
