#pragma once

#include "core/map/publish_file.h"
#include "core/map/sqlite.h"

namespace perennial {

/// An empty map with its tables in a partial file, and a transaction begun in it, which completeMap() ends.
/// Nobody else looks at the partial file and it is worthless after a crash, so it needs neither journal nor
/// syncing; SQLite's cache is bounded, what exceeds it goes to the file. After a statement that failed
/// nothing can be made of it.
Database createMap(PartialFile& partial);

/// From now on it is a whole map of the present format version. What it holds is on the disk before it is
/// called so: a power failure must not leave something that only looks like one.
void completeMap(const Database& database, PartialFile& partial);

}  // namespace perennial
