#pragma once

#include <string>
#include <vector>

#include "core/map/map_rows.h"
#include "core/map/sqlite.h"

namespace perennial {

/// Reads a map that could be opened entirely: every page, SQLite's structures, every row and blob, and
/// whether they fit each other. Returns what is wrong, one line each. Memory does not grow with the map.
std::vector<std::string> verifyMap(const Database& database, const StoredMetadata& stored);

}  // namespace perennial
