#include "core/map/map_opening.h"

#include <array>
#include <cstring>
#include <filesystem>

#include "core/map/checksum_vfs.h"
#include "core/map/map_rows.h"
#include "core/map/map_schema.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

/// What the first bytes of the file say, without any check.
struct Header {
  bool is_sqlite = false;
  std::uint32_t application = 0;
  std::uint32_t version = 0;
};

sqlite3_file* fileOf(const Database& database) {
  sqlite3_file* file = nullptr;
  sqlite3_file_control(database.handle(), "main", SQLITE_FCNTL_FILE_POINTER, &file);
  return file;
}

/// Through SQLite's own handle: closing another one would drop the locks that this process holds on the file.
Header readHeader(const Database& database) {
  std::array<std::uint8_t, 100> bytes{};
  sqlite3_file* file = fileOf(database);
  if (file == nullptr || file->pMethods == nullptr) {
    return {};
  }
  file->pMethods->xRead(file, bytes.data(), static_cast<int>(bytes.size()), 0);
  const auto bigEndian = [&bytes](std::size_t i) {
    return std::uint32_t{bytes[i]} << 24 | std::uint32_t{bytes[i + 1]} << 16 |
           std::uint32_t{bytes[i + 2]} << 8 | std::uint32_t{bytes[i + 3]};
  };
  return {std::memcmp(bytes.data(), "SQLite format 3", 16) == 0, bigEndian(68), bigEndian(60)};
}

void checkHeader(const std::string& file, const Header& header) {
  if (!header.is_sqlite) {
    throw MapError("'" + file +
                   "' is not a map, or its beginning is damaged: it is no SQLite file. Give the file of a "
                   "taught map (*.perennial)");
  }
  if (header.application != kMapApplicationId) {
    throw MapError("'" + file +
                   "' is not a map: it is an SQLite file of another program. Give the file of a taught map "
                   "(*.perennial)");
  }
  if (header.version == 0) {
    throw MapError("'" + file +
                   "' is an unfinished map, left behind when teaching was interrupted. It holds no whole "
                   "path: remove it and teach the path again");
  }
  if (header.version > kMapFormatVersion) {
    throw MapError("map '" + file + "' has format version " + std::to_string(header.version) +
                   "; this program knows versions up to " + std::to_string(kMapFormatVersion) +
                   ". Use the newer program that wrote it");
  }
}

void checkFile(const std::string& file) {
  std::error_code problem;
  const fs::file_status status = fs::status(file, problem);
  if (!fs::exists(status)) {
    throw MapError("map '" + file + "' does not exist: check its name and folder");
  }
  if (fs::is_directory(status)) {
    throw MapError("'" + file + "' is a folder, not a map: give the file of a taught map (*.perennial)");
  }
  if (fs::file_size(file, problem) == 0 && !problem) {
    throw MapError("'" + file + "' is empty, not a map: remove it and teach the path again");
  }
}

/// The first page is tested by itself: SQLite believes its size fields before it reads the page as a whole.
void checkFirstPage(const Database& database) {
  Page page{};
  sqlite3_file* file = fileOf(database);
  if (file->pMethods->xRead(file, page.data(), static_cast<int>(page.size()), 0) != SQLITE_OK) {
    throwDamaged(database.file(), "the checksum of its first page is wrong");
  }
}

}  // namespace

Database openMapDatabase(const std::string& file) {
  checkFile(file);
  Database database = Database::openMap(file);
  // A file from anywhere must not be able to run anything.
  sqlite3_db_config(database.handle(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  try {
    // Every commit must be on the disk when it returns; with FULL, the journal might come back and undo it.
    database.execute("PRAGMA synchronous=EXTRA; PRAGMA cell_size_check=ON; PRAGMA trusted_schema=OFF");
    // The first access undoes what a crash interrupted; only then is the header what it should be.
    Transaction reading(database, "BEGIN");
    database.integer("PRAGMA schema_version");
    checkHeader(file, readHeader(database));
    checkFirstPage(database);
    if (database.integer("PRAGMA page_size") != static_cast<std::int64_t>(kPageSize) ||
        !hasMapSchema(database)) {
      throwDamaged(file, "its tables are not those of a map");
    }
  } catch (const SqliteError& error) {
    if (error.code() == SQLITE_CORRUPT || error.code() == SQLITE_NOTADB) {
      checkHeader(file, readHeader(database));
    }
    throw;
  }
  return database;
}

}  // namespace perennial
