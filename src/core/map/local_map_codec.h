#pragma once

#include <cstdint>
#include <vector>

#include "perennial/core/local_map.h"

namespace perennial {

using Bytes = std::vector<std::uint8_t>;

/// A local map as stored in the map file, exact to the last bit; laid out in docs/map_format.md.
Bytes encodeLocalMap(const LocalMap& map);

/// The inverse. Throws MapError for bytes that are not exactly one valid local map, however they came about.
LocalMap decodeLocalMap(const Bytes& bytes);

}  // namespace perennial
