#include "perennial/core/map_file.h"

#include <cmath>
#include <limits>

#include "core/map/map_compaction.h"
#include "core/map/map_creation.h"
#include "core/map/map_image.h"
#include "core/map/map_migration.h"
#include "core/map/map_opening.h"
#include "core/map/map_rows.h"
#include "core/map/map_verify.h"
#include "core/map/staging.h"

namespace perennial {
namespace {

constexpr int kWriterPatienceMs = 200;  // for commits in progress; a traversal takes longer

/// A traversal that has begun and is not committed.
struct OpenTraversal {
  TraversalInfo info;
  Staging staging;
};

std::uint32_t newestTraversal(const Database& database) {
  return static_cast<std::uint32_t>(database.integer("SELECT max(traversal) FROM traversal"));
}

}  // namespace

struct MapFile::Implementation {
  explicit Implementation(const std::string& file) : database(openMapDatabase(file)) {
    Transaction reading(database, "BEGIN");
    stored = readMetadata(database);
    profile = readProfile(database, stored.profile_entries);
  }

  void requireIndex(std::uint32_t index) const;
  void requireTraversal() const;
  void requireUnmoved() const;
  void lockForWriting() const;
  static void lockInPresentFormat(std::unique_ptr<Implementation>& map);
  void writeStaged(double end_stamp_s);
  void endTraversal();

  Database database;
  StoredMetadata stored;
  PathProfile profile;
  std::optional<OpenTraversal> open;
};

void MapFile::Implementation::requireIndex(std::uint32_t index) const {
  if (index >= stored.local_maps) {
    throw MapError("map '" + database.file() + "' has no local map " + std::to_string(index) +
                   ", only 0 to " + std::to_string(stored.local_maps - 1));
  }
}

void MapFile::Implementation::requireTraversal() const {
  if (!open) {
    throw MapError("map '" + database.file() + "': no traversal is open");
  }
}

/// The name may have been given to another file since this one was opened, by a migration or a compaction.
void MapFile::Implementation::requireUnmoved() const {
  int moved = 0;
  sqlite3_file_control(database.handle(), "main", SQLITE_FCNTL_HAS_MOVED, &moved);
  if (moved != 0) {
    database.execute("ROLLBACK");
    throw MapError("map '" + database.file() +
                   "' was replaced or removed after it was opened: open it again");
  }
}

void MapFile::Implementation::lockForWriting() const {
  if (database.isReadOnly()) {
    throw MapError("map '" + database.file() +
                   "' cannot be written: check the permissions of the file and its folder");
  }
  database.setPatience(kWriterPatienceMs);
  try {
    database.execute("BEGIN IMMEDIATE");
  } catch (const SqliteError& error) {
    database.setPatience(Database::kPatienceMs);
    if (error.code() == SQLITE_BUSY) {
      throw MapError("map '" + database.file() +
                     "' is being updated by another program, and only one may at a time: "
                     "stop the other map manager or wait for the end of its traversal");
    }
    throw;
  }
  database.setPatience(Database::kPatienceMs);
  requireUnmoved();
}

/// Leaves the transaction open in which something can be written.
void MapFile::Implementation::lockInPresentFormat(std::unique_ptr<Implementation>& map) {
  map->lockForWriting();
  if (map->stored.format_version == kMapFormatVersion) {
    return;
  }
  const std::string file = map->database.file();
  {
    const Transaction nobody_learns(map->database);
    migrateMap(map->database, map->stored);
  }
  map = std::make_unique<Implementation>(file);
  map->lockForWriting();
}

void MapFile::Implementation::writeStaged(double end_stamp_s) {
  TraversalInfo info = open->info;
  info.end_stamp_s = end_stamp_s;
  info.updated_maps = open->staging.size();
  writeTraversal(database, info);
  Statement insert(database, "INSERT INTO state VALUES(NULL, ?, ?, ?, ?)");
  open->staging.forEach([&](std::uint32_t local_map, const Bytes& features) {
    insert.bind(0, std::int64_t{local_map}).bind(1, std::int64_t{info.id}).bind(2, features);
    insert.bind(3, std::int64_t{stateChecksum(local_map, info.id, features)}).run();
  });
}

void MapFile::Implementation::endTraversal() {
  if (database.inTransaction()) {
    database.execute("ROLLBACK");
  }
  open.reset();
}

MapFile::MapFile(const std::string& file) : implementation_(std::make_unique<Implementation>(file)) {}
MapFile::~MapFile() = default;
MapFile::MapFile(MapFile&&) noexcept = default;
MapFile& MapFile::operator=(MapFile&&) noexcept = default;

const std::string& MapFile::file() const { return implementation_->database.file(); }
const MapMetadata& MapFile::metadata() const { return implementation_->stored.metadata; }
const PathProfile& MapFile::profile() const { return implementation_->profile; }
std::size_t MapFile::size() const { return implementation_->stored.local_maps; }
std::uint32_t MapFile::formatVersion() const { return implementation_->stored.format_version; }

LocalMap MapFile::read(std::uint32_t index) const {
  implementation_->requireIndex(index);
  if (implementation_->open) {
    const std::optional<Bytes> staged = implementation_->open->staging.find(index);
    if (staged) {
      return decodeLocalMap(*staged);
    }
  }
  return readState(implementation_->database, index, std::numeric_limits<std::uint32_t>::max());
}

LocalMap MapFile::readAt(std::uint32_t index, std::uint32_t traversal) const {
  implementation_->requireIndex(index);
  const std::uint32_t newest = newestTraversal(implementation_->database);
  if (traversal > newest) {
    throw MapError("map '" + file() + "' has no traversal " + std::to_string(traversal) + ", only 0 to " +
                   std::to_string(newest));
  }
  return readState(implementation_->database, index, traversal);
}

cv::Mat MapFile::readImage(std::uint32_t index) const {
  implementation_->requireIndex(index);
  return perennial::readImage(implementation_->database, index, metadata());
}

std::vector<std::uint8_t> MapFile::readImagePng(std::uint32_t index) const {
  implementation_->requireIndex(index);
  return readPng(implementation_->database, index);
}

std::vector<LocalMapPlace> MapFile::between(double from_m, double to_m) const {
  Statement query(implementation_->database,
                  "SELECT local_map, distance_m FROM local_map WHERE distance_m BETWEEN ? AND ? "
                  "ORDER BY distance_m, local_map");
  query.bind(0, from_m).bind(1, to_m);
  std::vector<LocalMapPlace> places;
  while (query.step()) {
    places.push_back({unsigned32(query, 0), query.real(1)});
  }
  return places;
}

LocalMapPlace MapFile::nearest(double distance_m) const {
  if (std::isnan(distance_m)) {
    throw MapError("map '" + file() + "': the distance asked for is not a number");
  }
  Statement before(implementation_->database,
                   "SELECT min(local_map), distance_m FROM local_map WHERE distance_m = "
                   "(SELECT max(distance_m) FROM local_map WHERE distance_m <= ?)");
  Statement after(implementation_->database,
                  "SELECT min(local_map), distance_m FROM local_map WHERE distance_m = "
                  "(SELECT min(distance_m) FROM local_map WHERE distance_m > ?)");
  const auto place = [distance_m](Statement& query) -> std::optional<LocalMapPlace> {
    const bool found = query.bind(0, distance_m).step() && query.type(0) != SQLITE_NULL;
    return found ? std::optional<LocalMapPlace>({unsigned32(query, 0), query.real(1)}) : std::nullopt;
  };
  const std::optional<LocalMapPlace> earlier = place(before);
  const std::optional<LocalMapPlace> later = place(after);
  if (!earlier && !later) {
    throwDamaged(file(), "it has no local maps");
  }
  if (!earlier || !later) {
    return earlier ? *earlier : *later;
  }
  return later->distance_m - distance_m < distance_m - earlier->distance_m ? *later : *earlier;
}

std::vector<TraversalInfo> MapFile::traversals() const { return readTraversals(implementation_->database); }

std::uint32_t MapFile::beginTraversal(const std::string& strategy, double start_stamp_s) {
  if (implementation_->open) {
    throw MapError("map '" + file() + "': a traversal is open already; commit or discard it first");
  }
  if (!std::isfinite(start_stamp_s)) {
    throw MapError("map '" + file() + "': the stamp of the traversal is not a valid number");
  }
  Staging staging(file());
  Implementation::lockInPresentFormat(implementation_);
  const std::uint32_t id = newestTraversal(implementation_->database) + 1;
  implementation_->open.emplace(
      OpenTraversal{{id, strategy, start_stamp_s, start_stamp_s, 0}, std::move(staging)});
  return id;
}

void MapFile::stage(const LocalMap& map) {
  implementation_->requireTraversal();
  implementation_->requireIndex(map.index);
  const std::string name = "map '" + file() + "', local map " + std::to_string(map.index);
  const std::string problem = map.problem();
  if (!problem.empty()) {
    throw MapError(name + " is not stored: " + problem);
  }
  const Place place = readPlace(implementation_->database, map.index);
  if (map.distance_m != place.distance_m || map.stamp_s != place.stamp_s) {
    throw MapError(name + " is not stored: its distance or stamp is not the taught one");
  }
  implementation_->open->staging.put(map.index, encodeLocalMap(map));
}

void MapFile::commitTraversal(double end_stamp_s) {
  implementation_->requireTraversal();
  if (!std::isfinite(end_stamp_s)) {
    throw MapError("map '" + file() + "': the stamp of the traversal is not a valid number");
  }
  const Database& database = implementation_->database;
  if (implementation_->open->staging.size() == 0) {
    return implementation_->endTraversal();
  }
  if (!database.inTransaction()) {  // a commit has failed before
    implementation_->lockForWriting();
    if (newestTraversal(database) + 1 != implementation_->open->info.id) {
      throw MapError("map '" + file() +
                     "' was changed by another program since the traversal began: discard it");
    }
  }
  Transaction transaction(database);
  implementation_->writeStaged(end_stamp_s);
  try {
    transaction.commit();
  } catch (const SqliteError& error) {
    if (error.isOfCommitted()) {
      implementation_->open.reset();
    }
    throw;
  }
  implementation_->open.reset();
}

void MapFile::discardTraversal() {
  implementation_->requireTraversal();
  implementation_->endTraversal();
}

MapSizes MapFile::sizes() const {
  const Database& database = implementation_->database;
  const auto bytes = [&database](const char* sql) {
    return static_cast<std::uint64_t>(database.integer(sql));
  };
  MapSizes sizes;
  sizes.file_bytes = bytes("PRAGMA page_count") * bytes("PRAGMA page_size");
  sizes.unused_bytes = bytes("PRAGMA freelist_count") * bytes("PRAGMA page_size");
  sizes.image_bytes = bytes("SELECT sum(length(png)) FROM image");
  sizes.taught_bytes = bytes("SELECT sum(length(features)) FROM state WHERE traversal = 0");
  sizes.learned_bytes = bytes("SELECT sum(length(features)) FROM state WHERE traversal > 0");
  return sizes;
}

void MapFile::rollback(std::uint32_t traversal) {
  if (implementation_->open) {
    throw MapError("map '" + file() + "': a traversal is open; commit or discard it before rolling back");
  }
  Implementation::lockInPresentFormat(implementation_);
  const Database& database = implementation_->database;
  Transaction transaction(database);
  const std::uint32_t newest = newestTraversal(database);
  if (traversal > newest) {
    throw MapError("map '" + file() + "' has no traversal " + std::to_string(traversal) + ", only 0 to " +
                   std::to_string(newest));
  }
  for (const char* sql :
       {"DELETE FROM state WHERE traversal > ?", "DELETE FROM traversal WHERE traversal > ?"}) {
    Statement(database, sql).bind(0, std::int64_t{traversal}).run();
  }
  transaction.commit();
}

void MapFile::compact(std::uint32_t keep) {
  if (implementation_->open) {
    throw MapError("map '" + file() + "': a traversal is open; commit or discard it before compacting");
  }
  const std::string file = this->file();
  Implementation::lockInPresentFormat(implementation_);
  {
    const Transaction nobody_learns(implementation_->database);
    PartialFile copy(file, PartialFile::Content::kCopy);
    {
      const Database target = createMap(copy);
      copyCompacted(implementation_->database, implementation_->stored, keep, target);
      completeMap(target, copy);
    }
    copy.replaceLocked();
  }
  implementation_ = std::make_unique<Implementation>(file);
}

std::vector<std::string> MapFile::verify() const {
  return verifyMap(implementation_->database, implementation_->stored);
}

}  // namespace perennial
