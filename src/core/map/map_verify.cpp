#include "core/map/map_verify.h"

#include <functional>

#include "core/map/checksum_vfs.h"
#include "core/map/map_image.h"

namespace perennial {
namespace {

/// Beyond that many there is nothing to be learned from more.
constexpr std::size_t kMaxProblems = 1000;

class Verification {
 public:
  Verification(const Database& database, const StoredMetadata& stored)
      : database_(database), stored_(stored) {}

  std::vector<std::string> run() {
    attempt([this] { checkPages(); });
    attempt([this] { checkStructure(); });
    attempt([this] { checkTraversals(); });
    attempt([this] { checkCounts(); });
    checkLocalMaps();
    attempt([this] { checkStates(); });
    return std::move(problems_);
  }

 private:
  void report(const std::string& problem) {
    if (problems_.size() < kMaxProblems) {
      problems_.push_back(problem);
    }
  }

  void attempt(const std::function<void()>& check) {
    try {
      check();
    } catch (const MapError& error) {
      report(error.what());
    }
  }

  /// Every byte of the file, those that SQLite does not use too.
  void checkPages() {
    Transaction reading(database_, "BEGIN");
    const std::int64_t pages = database_.integer("PRAGMA page_count");
    sqlite3_file* file = nullptr;
    sqlite3_file_control(database_.handle(), "main", SQLITE_FCNTL_FILE_POINTER, &file);
    sqlite3_int64 size = 0;
    file->pMethods->xFileSize(file, &size);
    if (size != pages * static_cast<std::int64_t>(kPageSize)) {
      report("the file is " + std::to_string(size) + " bytes long instead of " +
             std::to_string(pages * static_cast<std::int64_t>(kPageSize)));
    }
    Page page{};
    for (std::int64_t i = 0; i < pages; ++i) {
      const int result = file->pMethods->xRead(file, page.data(), static_cast<int>(kPageSize),
                                               i * static_cast<std::int64_t>(kPageSize));
      if (result != SQLITE_OK) {
        report("page " + std::to_string(i + 1) + " is damaged or cannot be read");
      }
    }
  }

  void checkStructure() {
    Statement check(database_, "PRAGMA integrity_check");
    while (check.step()) {
      if (check.text(0) != "ok") {
        report(check.text(0));
      }
    }
  }

  void checkTraversals() {
    for (const TraversalInfo& traversal : readTraversals(database_)) {
      Statement count(database_, "SELECT count(*) FROM state WHERE traversal = ?");
      count.bind(0, std::int64_t{traversal.id}).step();
      if (count.integer(0) != static_cast<std::int64_t>(traversal.updated_maps)) {
        report("traversal " + std::to_string(traversal.id) + " has " + std::to_string(count.integer(0)) +
               " states instead of " + std::to_string(traversal.updated_maps));
      }
    }
    readProfile(database_, stored_.profile_entries);
  }

  void checkCounts() {
    const auto expected = static_cast<std::int64_t>(stored_.local_maps);
    if (database_.integer("SELECT count(*) FROM local_map") != expected ||
        database_.integer("SELECT count(*) FROM image") != expected) {
      report("the number of local maps or images is not " + std::to_string(expected));
    }
    if (database_.integer(
            "SELECT count(*) FROM state WHERE traversal NOT IN (SELECT traversal FROM traversal) OR "
            "local_map NOT IN (SELECT local_map FROM local_map)") != 0) {
      report("there are states of traversals or local maps that do not exist");
    }
  }

  void checkLocalMaps() {
    double last_distance_m = 0.0;
    for (std::uint32_t i = 0; i < stored_.local_maps && problems_.size() < kMaxProblems; ++i) {
      attempt([&] {
        const Place place = readPlace(database_, i);
        if (!(place.distance_m >= last_distance_m) || place.distance_m > stored_.metadata.length_m) {
          report("local map " + std::to_string(i) +
                 " lies before the one before it or beyond the path's end");
        }
        last_distance_m = place.distance_m;
        readImage(database_, i, stored_.metadata);
      });
    }
  }

  void checkStates() {
    Statement query(database_, "SELECT local_map, traversal FROM state ORDER BY local_map, traversal");
    while (query.step() && problems_.size() < kMaxProblems) {
      attempt([&] {
        const std::uint32_t index = unsigned32(query, 0);
        const LocalMap map = readState(database_, index, unsigned32(query, 1));
        const Place place = readPlace(database_, index);
        if (map.distance_m != place.distance_m || map.stamp_s != place.stamp_s) {
          report("local map " + std::to_string(index) + " has moved since it was taught");
        }
      });
    }
  }

  const Database& database_;
  const StoredMetadata& stored_;
  std::vector<std::string> problems_;
};

}  // namespace

std::vector<std::string> verifyMap(const Database& database, const StoredMetadata& stored) {
  return Verification(database, stored).run();
}

}  // namespace perennial
