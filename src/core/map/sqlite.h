#pragma once

#include <sqlite3.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "perennial/core/error.h"

namespace perennial {

/// What SQLite refused to do, with the file's name, SQLite's words and what to do about it.
class SqliteError : public MapError {
 public:
  SqliteError(const std::string& message, int code) : MapError(message), code_(code) {}
  /// Primary result code: SQLITE_BUSY, SQLITE_CORRUPT ...
  int code() const { return code_ & 0xFF; }
  /// The transaction is done, but a power failure could still undo it: the folder could not be synced.
  bool isOfCommitted() const { return code_ == SQLITE_IOERR_DIR_FSYNC; }

 private:
  int code_;
};

/// One connection. One thread at a time.
class Database {
 public:
  /// An existing map file, through the layer of page checksums; for reading alone where writing is not
  /// allowed. Does not look into the file.
  static Database openMap(const std::string& file);
  /// An empty database on disk that vanishes with the connection; `file` is named in errors.
  static Database openTemporary(const std::string& file);

  /// Runs statements that give no rows.
  void execute(const char* sql) const;
  /// Value of a pragma, or of any statement with a single integer as result.
  std::int64_t integer(const char* sql) const;
  /// How long to wait for another program's lock.
  void setPatience(int milliseconds) const;
  bool inTransaction() const { return sqlite3_get_autocommit(handle_.get()) == 0; }
  bool isReadOnly() const { return sqlite3_db_readonly(handle_.get(), "main") == 1; }

  sqlite3* handle() const { return handle_.get(); }
  const std::string& file() const { return file_; }

  /// How long a connection waits for locks unless told otherwise: longer than any commit takes.
  static constexpr int kPatienceMs = 60000;

  /// Throws SqliteError for the connection's last error.
  [[noreturn]] void fail() const;

 private:
  struct Closer {
    void operator()(sqlite3* handle) const { sqlite3_close(handle); }
  };
  Database(const std::string& file, const char* path, int flags, const char* vfs);

  std::string file_;
  std::unique_ptr<sqlite3, Closer> handle_;
};

/// A prepared statement. Parameters and columns count from 0. Must not outlive its database.
class Statement {
 public:
  Statement(const Database& database, const char* sql);

  Statement& bind(int parameter, std::int64_t value);
  Statement& bind(int parameter, double value);
  Statement& bind(int parameter, const std::string& text);
  Statement& bind(int parameter, const std::vector<std::uint8_t>& blob);

  /// Next row; false when there is none.
  bool step();
  /// Runs a statement without rows and makes it ready for the next parameters.
  void run();

  std::int64_t integer(int column) const { return sqlite3_column_int64(handle_.get(), column); }
  double real(int column) const { return sqlite3_column_double(handle_.get(), column); }
  std::string text(int column) const;
  std::vector<std::uint8_t> blob(int column) const;
  int type(int column) const { return sqlite3_column_type(handle_.get(), column); }

 private:
  struct Finalizer {
    void operator()(sqlite3_stmt* handle) const { sqlite3_finalize(handle); }
  };
  void check(int result) const;

  const Database* database_;
  std::unique_ptr<sqlite3_stmt, Finalizer> handle_;
};

/// A transaction that is rolled back unless it is committed.
class Transaction {
 public:
  /// `begin`: "BEGIN", "BEGIN IMMEDIATE" or "BEGIN EXCLUSIVE".
  Transaction(const Database& database, const char* begin) : database_(database) { database_.execute(begin); }
  /// Takes over one that has begun.
  explicit Transaction(const Database& database) : database_(database) {}
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  void commit() { database_.execute("COMMIT"); }

 private:
  const Database& database_;
};

}  // namespace perennial
