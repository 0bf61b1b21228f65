#pragma once

#include <sqlite3.h>

#include <array>
#include <cstddef>
#include <cstdint>

namespace perennial {

/// Every page of a map file ends in a CRC-32 of its number and content, kept in the bytes that SQLite
/// reserves at the end of a page for such purposes. It is written and tested by a layer below SQLite (a VFS
/// shim over the platform's own one), so that a flipped bit is found wherever it is, in unused bytes as well.
/// Any SQLite program can read a map; one that writes it without this layer leaves pages that count as
/// damaged.
constexpr std::size_t kPageSize = 4096;
constexpr std::size_t kPageChecksumSize = 4;

using Page = std::array<std::uint8_t, kPageSize>;

/// Name of the layer for sqlite3_open_v2(); registers it at the first call. It stands on whatever VFS is
/// SQLite's default when a file is opened. A damaged page makes SQLite report SQLITE_CORRUPT. Safe from any
/// thread.
const char* checksumVfsName();

/// First and only page of an empty database whose pages have room for their checksum.
Page emptyDatabase(std::uint32_t application_id);

/// Writes the checksum of page `number` (from 1) into its last bytes.
void sealPage(std::uint8_t* page, std::uint32_t number);

/// True when the checksum is right, or all bytes are zero: SQLite leaves pages it never uses unwritten.
bool pageIsIntact(const std::uint8_t* page, std::uint32_t number);

}  // namespace perennial
