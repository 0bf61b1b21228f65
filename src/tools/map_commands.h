#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

namespace perennial {

// The commands of map_tool. Each prints to `out` and throws MapError for a map that cannot be used.

/// Local maps of a map, one line each; of a folder, its maps.
void listMap(const std::string& file_or_folder, std::ostream& out);

/// Metadata, sizes and number of traversals.
void printInfo(const std::string& file, std::ostream& out);

/// Every problem found; false when there is any.
bool verifyMap(const std::string& file, std::ostream& out);

/// Traversals that the map has learned from, one line each.
void printHistory(const std::string& file, std::ostream& out);

/// Forgets what was learned after a traversal.
void rollBack(const std::string& file, std::uint32_t traversal, std::ostream& out);

/// Merges all but the newest `keep` traversals and gives the room that they took back.
void compactMap(const std::string& file, std::uint32_t keep, std::ostream& out);

/// Writes images as PNG, features and local maps as CSV, metadata and profile as YAML into a folder, which
/// must be empty or not exist. Numbers are written so that reading them gives the same bits.
void exportMap(const std::string& file, const std::string& folder, std::ostream& out);

struct ImportOptions {
  std::string name;      ///< of the map in the folder; empty: the only one
  std::string file;      ///< to write; empty: NAME.perennial
  std::string encoding;  ///< of the camera to drive with; empty: mono8, or bgr8 for a map with colours
};

/// Makes a map to drive with from one of the reference system (reference_map.h): images, distances, times and
/// velocities are kept, features are extracted anew from the images, as if the path had been taught with
/// them. Throws DatasetError, naming the file, for what is malformed, for a local map without an image, for
/// images that differ in size or colours, and when there is no path profile.
void importMap(const std::string& folder, const ImportOptions& options, std::ostream& out);

}  // namespace perennial
