#include "map_commands.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <iostream>

#include "perennial/core/error.h"
#include "perennial/core/map_file.h"
#include "perennial/core/map_name.h"
#include "perennial/core/utc_time.h"

namespace perennial {
namespace {

/// A stamp for people.
std::string dateTime(double stamp_s) {
  try {
    return formatUtc(stamp_s);
  } catch (const Error&) {
    return std::to_string(stamp_s) + " s";  // out of the calendar's range
  }
}

/// The same for a column of a table.
std::string dateTimeColumn(double stamp_s) {
  std::string text = dateTime(stamp_s);
  text.resize(std::max(text.size(), std::string("2026-06-21T20:30:00.123456Z").size()), ' ');
  return text;
}

std::string megabytes(std::uint64_t bytes) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2f MB", static_cast<double>(bytes) / 1e6);
  return text;
}

void printMigration(const MapFile& map, std::uint32_t version_before, std::ostream& out) {
  if (map.formatVersion() != version_before) {
    out << "map '" << map.file() << "' was migrated to format version " << map.formatVersion()
        << "; the original is kept as '" << keptMapFile(map.file(), version_before) << "'\n";
  }
}

void listFolder(const std::string& folder, std::ostream& out) {
  for (const std::string& name : listMaps(folder)) {
    out << name << "  ";
    try {
      const MapFile map(mapFile(folder, name));
      out << std::fixed << std::setprecision(1) << map.metadata().length_m << " m, " << map.size()
          << " local maps, " << map.traversals().size() - 1 << " traversals, taught "
          << dateTime(map.metadata().taught_stamp_s) << "\n";
    } catch (const MapError& error) {
      out << "unusable: " << error.what() << "\n";
    }
  }
}

}  // namespace

void listMap(const std::string& file_or_folder, std::ostream& out) {
  if (std::filesystem::is_directory(file_or_folder)) {
    return listFolder(file_or_folder, out);
  }
  const MapFile map(file_or_folder);
  out << "index  distance_m  stamp                        features  strategy\n" << std::fixed;
  for (std::uint32_t i = 0; i < map.size(); ++i) {
    const LocalMap local = map.read(i);
    out << std::setw(5) << i << "  " << std::setw(10) << std::setprecision(3) << local.distance_m << "  "
        << dateTimeColumn(local.stamp_s) << "  " << std::setw(8) << local.size() << "  "
        << (local.strategy.empty() ? "-" : local.strategy) << "\n";
  }
}

void printInfo(const std::string& file, std::ostream& out) {
  const MapFile map(file);
  const MapMetadata& metadata = map.metadata();
  const MapSizes sizes = map.sizes();
  out << "name            " << metadata.name << "\n"
      << "format version  " << map.formatVersion() << "\n"
      << "camera          " << metadata.camera << "\n"
      << "images          " << metadata.image_width << "x" << metadata.image_height << " px, "
      << metadata.image_encoding << "\n"
      << "extraction      " << metadata.extraction << "\n"
      << "taught          " << dateTime(metadata.taught_stamp_s) << "\n"
      << "length          " << metadata.length_m << " m\n"
      << "local maps      " << map.size() << ", every " << metadata.map_interval_m << " m\n"
      << "profile         " << map.profile().entries().size() << " entries\n"
      << "traversals      " << map.traversals().size() - 1 << " beside the teaching\n"
      << "file            " << megabytes(sizes.file_bytes) << ", of which unused "
      << megabytes(sizes.unused_bytes) << "\n"
      << "images          " << megabytes(sizes.image_bytes) << "\n"
      << "taught features " << megabytes(sizes.taught_bytes) << "\n"
      << "learned states  " << megabytes(sizes.learned_bytes) << "\n";
}

bool verifyMap(const std::string& file, std::ostream& out) {
  const MapFile map(file);
  const std::vector<std::string> problems = map.verify();
  for (const std::string& problem : problems) {
    out << problem << "\n";
  }
  out << "map '" << file << "': " << (problems.empty() ? "no" : std::to_string(problems.size()))
      << " problems in " << map.size() << " local maps and " << map.traversals().size() << " traversals\n";
  return problems.empty();
}

void printHistory(const std::string& file, std::ostream& out) {
  const MapFile map(file);
  out << "traversal  begin                        end                          updated maps  strategy\n";
  for (const TraversalInfo& traversal : map.traversals()) {
    out << std::setw(9) << traversal.id << "  " << dateTimeColumn(traversal.start_stamp_s) << "  "
        << dateTimeColumn(traversal.end_stamp_s) << "  " << std::setw(12) << traversal.updated_maps << "  "
        << (traversal.id == 0 ? "(taught)" : traversal.strategy) << "\n";
  }
}

void rollBack(const std::string& file, std::uint32_t traversal, std::ostream& out) {
  MapFile map(file);
  const std::size_t before = map.traversals().size();
  const std::uint32_t version = map.formatVersion();
  map.rollback(traversal);
  printMigration(map, version, out);
  out << "map '" << file << "': " << before - map.traversals().size()
      << " traversals forgotten; the newest is now " << traversal << "\n";
}

void compactMap(const std::string& file, std::uint32_t keep, std::ostream& out) {
  MapFile map(file);
  const std::size_t traversals = map.traversals().size();
  const std::uint64_t before = map.sizes().file_bytes;
  const std::uint32_t version = map.formatVersion();
  map.compact(keep);
  printMigration(map, version, out);
  out << "map '" << file << "': " << traversals - map.traversals().size()
      << " traversals merged into others, " << megabytes(before) << " before, "
      << megabytes(map.sizes().file_bytes) << " now\n";
}

}  // namespace perennial
