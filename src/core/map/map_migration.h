#pragma once

#include <cstdint>
#include <string>

#include "core/map/map_rows.h"
#include "core/map/sqlite.h"

namespace perennial {

/// Puts a copy in the present format in the place of the map that `source` has open, in one step, and keeps
/// the original beside it (keptMapFile()). The copy is complete, compared with the original, verified and
/// synced before. The caller holds the write lock (BEGIN IMMEDIATE) in `source`, which shows the original
/// afterwards: open the file anew. A crash leaves the map untouched, and at most a `<file>.copy` that the
/// next attempt replaces. Throws MigrationError, with the map as it was.
void migrateMap(const Database& source, const StoredMetadata& stored);

}  // namespace perennial
