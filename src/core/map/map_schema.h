#pragma once

#include <cstdint>

#include "core/map/sqlite.h"

namespace perennial {

/// "PRNL", in the header of the file: says that an SQLite file is a map.
constexpr std::uint32_t kMapApplicationId = 0x50524E4C;

/// Version of the format, SQLite's user_version. 0: a map whose teaching has not been finished. Older
/// versions are read as they are, and migrated when something is to be written (map_migration.h).
constexpr std::uint32_t kMapFormatVersion = 2;

/// Creates the tables in an empty database.
void createSchema(const Database& database);

/// True when the file has exactly the tables and indices of a map; they are the same in all versions so far.
bool hasMapSchema(const Database& database);

}  // namespace perennial
