#pragma once

#include <cstdint>

#include "core/map/map_rows.h"
#include "core/map/sqlite.h"

namespace perennial {

/// Copies a map into an empty one (createMap()), keeping only the newest `keep` traversals one by one: what
/// was learned before them becomes one traversal, number 1, and the others are numbered from 2 on. The taught
/// state stays what it is. Every row is checked on the way. Throws MapError when one is damaged.
void copyCompacted(const Database& source, const StoredMetadata& stored, std::uint32_t keep,
                   const Database& target);

}  // namespace perennial
