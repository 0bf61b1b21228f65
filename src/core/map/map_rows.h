#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/map/local_map_codec.h"
#include "core/map/map_schema.h"
#include "core/map/sqlite.h"
#include "perennial/core/map_file.h"

namespace perennial {

// Reading and writing the tables of a map file, row by row, with their checksums. Every reader throws
// MapError, naming the file and the row, when a row is missing or damaged.

[[noreturn]] void throwDamaged(const std::string& file, const std::string& what);

/// Metadata with the counts that make missing rows noticed. Read from an older format it says what the
/// present one would: the extraction names its descriptor.
struct StoredMetadata {
  MapMetadata metadata;
  std::size_t local_maps = 0;
  std::size_t profile_entries = 0;
  std::uint32_t format_version = kMapFormatVersion;  ///< of the file
};

/// Empty, or which member of the metadata is not usable.
std::string metadataProblem(const MapMetadata& metadata);

/// In the present format, whatever the one was that it was read from.
void writeMetadata(const Database& database, const StoredMetadata& stored);
StoredMetadata readMetadata(const Database& database);

void writeProfile(const Database& database, const PathProfile& profile);
PathProfile readProfile(const Database& database, std::size_t entries);

std::uint32_t placeChecksum(std::uint32_t local_map, double distance_m, double stamp_s);
std::uint32_t imageChecksum(std::uint32_t local_map, const Bytes& png);
std::uint32_t stateChecksum(std::uint32_t local_map, std::uint32_t traversal, const Bytes& features);

void writeTraversal(const Database& database, const TraversalInfo& traversal);
std::vector<TraversalInfo> readTraversals(const Database& database);

/// When and where a local map was taught.
struct Place {
  double distance_m = 0.0;
  double stamp_s = 0.0;
};
Place readPlace(const Database& database, std::uint32_t local_map);

/// Newest state of a local map that is not newer than `traversal`.
LocalMap readState(const Database& database, std::uint32_t local_map, std::uint32_t traversal);
/// Stored PNG, not decoded.
Bytes readPng(const Database& database, std::uint32_t local_map);

/// An integer column that holds a uint32; -1 cast, that is 0xFFFFFFFF, for anything else, which no checksum
/// agrees with by more than chance.
std::uint32_t unsigned32(const Statement& row, int column);

}  // namespace perennial
