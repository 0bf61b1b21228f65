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

/// Writes images as PNG, features and local maps as CSV, metadata and profile as YAML into a folder, which
/// must be empty or not exist. Numbers are written so that reading them gives the same bits.
void exportMap(const std::string& file, const std::string& folder, std::ostream& out);

}  // namespace perennial
