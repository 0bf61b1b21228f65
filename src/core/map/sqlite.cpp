#include "core/map/sqlite.h"

#include <cstring>

#include "core/map/checksum_vfs.h"

namespace perennial {
namespace {

std::string remedy(int code) {
  if (code == SQLITE_IOERR_DIR_FSYNC) {
    return "it is written, but may be lost if the power fails; check the disk and the system's log";
  }
  switch (code & 0xFF) {
    case SQLITE_FULL:
      return "free some space and try again; what the map held before is unharmed";
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "another program is using it; wait for it to finish or stop it";
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return "the file is damaged; `map_tool verify` lists where. Restore it from a copy, or teach the path "
             "again";
    case SQLITE_READONLY:
      return code == SQLITE_READONLY_DBMOVED
                 ? "the file was replaced or removed after it was opened; open it again"
                 : "check the permissions of the file and its folder";
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      return "check that file and folder exist and their permissions";
    default:
      return "check the disk and the system's log";
  }
}

[[noreturn]] void throwError(sqlite3* handle, const std::string& file, int code) {
  std::string message =
      "map '" + file + "': " + (handle == nullptr ? sqlite3_errstr(code) : sqlite3_errmsg(handle));
  const int system_error = handle == nullptr ? 0 : sqlite3_system_errno(handle);
  if ((code & 0xFF) == SQLITE_IOERR && system_error != 0) {
    message += std::string(" (") + std::strerror(system_error) + ")";
  }
  throw SqliteError(message + ": " + remedy(code), code);
}

}  // namespace

Database::Database(const std::string& file, const char* path, int flags, const char* vfs) : file_(file) {
  sqlite3* handle = nullptr;
  const int result = sqlite3_open_v2(path, &handle, flags | SQLITE_OPEN_NOMUTEX, vfs);
  handle_.reset(handle);
  if (result != SQLITE_OK) {
    throwError(handle, file_, result);
  }
  sqlite3_extended_result_codes(handle, 1);
  sqlite3_busy_timeout(handle, kPatienceMs);
}

Database Database::openMap(const std::string& file) {
  return Database(file, file.c_str(), SQLITE_OPEN_READWRITE, checksumVfsName());
}

Database Database::openTemporary(const std::string& file) {
  Database database(file, "", SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  database.execute("PRAGMA temp_store=FILE; PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF");
  return database;
}

void Database::execute(const char* sql) const {
  if (sqlite3_exec(handle_.get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) {
    fail();
  }
}

std::int64_t Database::integer(const char* sql) const {
  Statement statement(*this, sql);
  return statement.step() ? statement.integer(0) : 0;
}

void Database::setPatience(int milliseconds) const { sqlite3_busy_timeout(handle_.get(), milliseconds); }

void Database::fail() const { throwError(handle_.get(), file_, sqlite3_extended_errcode(handle_.get())); }

Statement::Statement(const Database& database, const char* sql) : database_(&database) {
  sqlite3_stmt* handle = nullptr;
  const int result = sqlite3_prepare_v2(database.handle(), sql, -1, &handle, nullptr);
  handle_.reset(handle);
  check(result);
}

void Statement::check(int result) const {
  if (result != SQLITE_OK) {
    database_->fail();
  }
}

Statement& Statement::bind(int parameter, std::int64_t value) {
  check(sqlite3_bind_int64(handle_.get(), parameter + 1, value));
  return *this;
}

Statement& Statement::bind(int parameter, double value) {
  check(sqlite3_bind_double(handle_.get(), parameter + 1, value));
  return *this;
}

Statement& Statement::bind(int parameter, const std::string& text) {
  check(sqlite3_bind_text(handle_.get(), parameter + 1, text.data(), static_cast<int>(text.size()),
                          SQLITE_TRANSIENT));
  return *this;
}

Statement& Statement::bind(int parameter, const std::vector<std::uint8_t>& blob) {
  check(sqlite3_bind_blob64(handle_.get(), parameter + 1, blob.data(), blob.size(), SQLITE_TRANSIENT));
  return *this;
}

bool Statement::step() {
  const int result = sqlite3_step(handle_.get());
  if (result != SQLITE_ROW && result != SQLITE_DONE) {
    database_->fail();
  }
  return result == SQLITE_ROW;
}

void Statement::run() {
  step();
  check(sqlite3_reset(handle_.get()));
}

std::string Statement::text(int column) const {
  const auto* bytes = static_cast<const char*>(sqlite3_column_blob(handle_.get(), column));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column));
  return bytes == nullptr ? std::string() : std::string(bytes, size);
}

std::vector<std::uint8_t> Statement::blob(int column) const {
  const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(handle_.get(), column));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column));
  return bytes == nullptr ? std::vector<std::uint8_t>() : std::vector<std::uint8_t>(bytes, bytes + size);
}

Transaction::~Transaction() {
  if (database_.inTransaction()) {
    sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
  }
}

}  // namespace perennial
