#include "core/map/map_migration.h"

#include <unistd.h>

#include <filesystem>
#include <limits>

#include "core/map/kept_map.h"
#include "core/map/map_compaction.h"
#include "core/map/map_creation.h"
#include "core/map/map_opening.h"
#include "core/map/map_verify.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kAllTraversals = std::numeric_limits<std::uint32_t>::max();

std::string megabytes(std::uintmax_t bytes) { return std::to_string((bytes + 999999) / 1000000) + " MB"; }

/// Before the copy fills the disk, and in no time. Other programs may still take the room meanwhile.
void requireRoom(const std::string& file) {
  std::error_code problem;
  const std::uintmax_t needed = fs::file_size(file, problem);
  const fs::path folder = fs::absolute(file, problem).parent_path();
  const fs::space_info space = problem ? fs::space_info{} : fs::space(folder, problem);
  const bool known = !problem && space.capacity > 0;  // not every file system says
  if (known && space.available < needed) {
    throw MapError("it needs " + megabytes(needed) + " in '" + folder.string() + "', of which " +
                   megabytes(space.available) + " are free: free some space");
  }
}

void writeCopy(const Database& source, const StoredMetadata& stored, PartialFile& copy) {
  const Database target = createMap(copy);
  copyCompacted(source, stored, kAllTraversals, target);
  completeMap(target, copy);
}

/// A row's checksum covers its number and all its content.
void requireSameRows(const Database& source, const Database& copy, const char* checksums) {
  Statement ours(source, checksums);
  Statement theirs(copy, checksums);
  bool more = true;
  while (more) {
    more = ours.step();
    if (theirs.step() != more || (more && ours.integer(0) != theirs.integer(0))) {
      throw MapError("'" + copy.file() + "' does not hold the same as the original: check the disk");
    }
  }
}

void requireFaithful(const Database& source, const std::string& file) {
  const Database copy = openMapDatabase(file);
  const std::vector<std::string> problems = verifyMap(copy, readMetadata(copy));
  if (!problems.empty()) {
    throw MapError(problems.front());
  }
  for (const char* checksums :
       {"SELECT crc FROM profile ORDER BY entry", "SELECT crc FROM local_map ORDER BY local_map",
        "SELECT crc FROM image ORDER BY local_map", "SELECT crc FROM traversal ORDER BY traversal",
        "SELECT crc FROM state ORDER BY local_map, traversal"}) {
    requireSameRows(source, copy, checksums);
  }
}

void migrate(const Database& source, const StoredMetadata& stored) {
  requireRoom(source.file());
  PartialFile copy(source.file(), PartialFile::Content::kCopy);
  writeCopy(source, stored, copy);
  requireFaithful(source, copy.path());
  const std::string kept = keptMapFile(source.file(), stored.format_version);
  const bool newly_kept = keepMapAs(source, kept);
  try {
    copy.replaceLocked();
  } catch (const MapError&) {
    if (newly_kept && !copy.hasFinalName()) {
      ::unlink(kept.c_str());
    }
    throw;
  }
}

}  // namespace

std::string keptMapFile(const std::string& file, std::uint32_t format_version) {
  return file + ".format" + std::to_string(format_version);
}

void migrateMap(const Database& source, const StoredMetadata& stored) {
  try {
    migrate(source, stored);
  } catch (const MapError& error) {
    throw MigrationError("map '" + source.file() + "' has format version " +
                         std::to_string(stored.format_version) +
                         " and cannot learn before it is migrated to version " +
                         std::to_string(kMapFormatVersion) + ", which failed: " + error.what());
  }
}

}  // namespace perennial
