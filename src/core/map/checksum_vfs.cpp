// A VFS shim as described at https://sqlite.org/vfs.html, section 2.2; file format at
// https://sqlite.org/fileformat2.html.
#include "core/map/checksum_vfs.h"

#include <algorithm>
#include <cstring>
#include <new>

#include "core/map/row_checksum.h"

namespace perennial {
namespace {

constexpr char kName[] = "perennial-checksum";

/// The platform's VFS, or a test's.
sqlite3_vfs* parent() { return sqlite3_vfs_find(nullptr); }

struct ChecksumFile {
  sqlite3_file base;   // first, so that SQLite's pointer is ours too
  sqlite3_file* real;  // memory from sqlite3_malloc, of the parent's szOsFile bytes
};

sqlite3_file* real(sqlite3_file* file) { return reinterpret_cast<ChecksumFile*>(file)->real; }

bool isWholePage(int amount, sqlite3_int64 offset) {
  return amount == static_cast<int>(kPageSize) && offset % static_cast<sqlite3_int64>(kPageSize) == 0;
}

std::uint32_t pageNumber(sqlite3_int64 offset) {
  return static_cast<std::uint32_t>(offset / static_cast<sqlite3_int64>(kPageSize) + 1);
}

int closeFile(sqlite3_file* file) {
  const int result = real(file)->pMethods->xClose(real(file));
  sqlite3_free(real(file));
  return result;
}

int readFile(sqlite3_file* file, void* buffer, int amount, sqlite3_int64 offset) {
  if (amount > static_cast<int>(kPageSize)) {
    return SQLITE_CORRUPT;  // the header promises larger pages than a map has
  }
  const int result = real(file)->pMethods->xRead(real(file), buffer, amount, offset);
  if (!isWholePage(amount, offset)) {
    return result;
  }
  const bool beyond_the_end = result == SQLITE_IOERR_SHORT_READ;
  if (result != SQLITE_OK && !beyond_the_end) {
    return result;
  }
  return pageIsIntact(static_cast<std::uint8_t*>(buffer), pageNumber(offset)) ? result : SQLITE_CORRUPT;
}

int writeFile(sqlite3_file* file, const void* buffer, int amount, sqlite3_int64 offset) {
  if (isWholePage(amount, offset)) {
    // In place, so that SQLite's copy, from which its rollback journal is written, has the checksum too. The
    // reserved bytes belong to the VFS; SQLite never looks at them.
    sealPage(static_cast<std::uint8_t*>(const_cast<void*>(buffer)), pageNumber(offset));
  }
  return real(file)->pMethods->xWrite(real(file), buffer, amount, offset);
}

int truncateFile(sqlite3_file* file, sqlite3_int64 size) {
  return real(file)->pMethods->xTruncate(real(file), size);
}
int syncFile(sqlite3_file* file, int flags) { return real(file)->pMethods->xSync(real(file), flags); }
int fileSize(sqlite3_file* file, sqlite3_int64* size) {
  return real(file)->pMethods->xFileSize(real(file), size);
}
int lockFile(sqlite3_file* file, int level) { return real(file)->pMethods->xLock(real(file), level); }
int unlockFile(sqlite3_file* file, int level) { return real(file)->pMethods->xUnlock(real(file), level); }
int checkReservedLock(sqlite3_file* file, int* reserved) {
  return real(file)->pMethods->xCheckReservedLock(real(file), reserved);
}
int fileControl(sqlite3_file* file, int operation, void* argument) {
  return real(file)->pMethods->xFileControl(real(file), operation, argument);
}
int sectorSize(sqlite3_file* file) { return real(file)->pMethods->xSectorSize(real(file)); }
int deviceCharacteristics(sqlite3_file* file) {
  return real(file)->pMethods->xDeviceCharacteristics(real(file));
}

/// Version 1: neither shared memory (no write-ahead log) nor memory mapping, which would both pass the checks
/// by.
const sqlite3_io_methods* methods() {
  static const sqlite3_io_methods table = [] {
    sqlite3_io_methods m{};
    m.iVersion = 1;
    m.xClose = closeFile;
    m.xRead = readFile;
    m.xWrite = writeFile;
    m.xTruncate = truncateFile;
    m.xSync = syncFile;
    m.xFileSize = fileSize;
    m.xLock = lockFile;
    m.xUnlock = unlockFile;
    m.xCheckReservedLock = checkReservedLock;
    m.xFileControl = fileControl;
    m.xSectorSize = sectorSize;
    m.xDeviceCharacteristics = deviceCharacteristics;
    return m;
  }();
  return &table;
}

/// Only database files are wrapped; journals are handed to the parent, which needs no more room than we
/// declared.
int openDatabaseFile(const char* name, sqlite3_file* file, int flags, int* flags_out) {
  auto* ours = reinterpret_cast<ChecksumFile*>(file);
  ours->base.pMethods = nullptr;
  ours->real = static_cast<sqlite3_file*>(sqlite3_malloc(parent()->szOsFile));
  if (ours->real == nullptr) {
    return SQLITE_NOMEM;
  }
  std::memset(ours->real, 0, static_cast<std::size_t>(parent()->szOsFile));
  const int result = parent()->xOpen(parent(), name, ours->real, flags, flags_out);
  if (result != SQLITE_OK) {
    sqlite3_free(ours->real);
    return result;
  }
  ours->base.pMethods = methods();
  return SQLITE_OK;
}

int openFile(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* flags_out) {
  if ((flags & SQLITE_OPEN_MAIN_DB) != 0) {
    return openDatabaseFile(name, file, flags, flags_out);
  }
  return parent()->xOpen(parent(), name, file, flags, flags_out);
}

int deleteFile(sqlite3_vfs*, const char* name, int sync) { return parent()->xDelete(parent(), name, sync); }
int accessFile(sqlite3_vfs*, const char* name, int flags, int* result) {
  return parent()->xAccess(parent(), name, flags, result);
}
int fullPathname(sqlite3_vfs*, const char* name, int size, char* result) {
  return parent()->xFullPathname(parent(), name, size, result);
}
int randomness(sqlite3_vfs*, int size, char* result) { return parent()->xRandomness(parent(), size, result); }
int pause(sqlite3_vfs*, int microseconds) { return parent()->xSleep(parent(), microseconds); }
int currentTime(sqlite3_vfs*, double* days) { return parent()->xCurrentTime(parent(), days); }
int lastError(sqlite3_vfs*, int size, char* text) { return parent()->xGetLastError(parent(), size, text); }

sqlite3_vfs* registered() {
  static sqlite3_vfs vfs = [] {
    sqlite3_vfs v{};
    v.iVersion = 1;
    v.szOsFile = std::max(static_cast<int>(sizeof(ChecksumFile)), parent()->szOsFile);
    v.mxPathname = parent()->mxPathname;
    v.zName = kName;
    v.xOpen = openFile;
    v.xDelete = deleteFile;
    v.xAccess = accessFile;
    v.xFullPathname = fullPathname;
    v.xRandomness = randomness;
    v.xSleep = pause;
    v.xCurrentTime = currentTime;
    v.xGetLastError = lastError;
    return v;
  }();
  static const int result = sqlite3_vfs_register(&vfs, 0);
  return result == SQLITE_OK ? &vfs : nullptr;
}

std::uint32_t pageChecksum(const std::uint8_t* page, std::uint32_t number) {
  return RowChecksum().add(number).addBytes(page, kPageSize - kPageChecksumSize).value();
}

}  // namespace

const char* checksumVfsName() { return registered() == nullptr ? nullptr : kName; }

Page emptyDatabase(std::uint32_t application_id) {
  Page page{};
  const auto putBigEndian = [&page](std::size_t offset, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) {
      page[offset + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
    }
  };
  std::memcpy(page.data(), "SQLite format 3", 16);
  putBigEndian(16, kPageSize << 16 | 0x0101);            // page size; read and written with rollback journals
  putBigEndian(20, kPageChecksumSize << 24 | 0x402020);  // reserved bytes; three constants of the format
  putBigEndian(24, 1);                                   // change counter
  putBigEndian(28, 1);                                   // pages
  putBigEndian(44, 4);                                   // schema format
  putBigEndian(56, 1);                                   // UTF-8
  putBigEndian(68, application_id);
  putBigEndian(92, 1);  // change counter for which the number of pages is valid
  putBigEndian(96, SQLITE_VERSION_NUMBER);
  page[100] = 13;  // an empty table leaf
  page[105] = (kPageSize - kPageChecksumSize) >> 8;
  page[106] = (kPageSize - kPageChecksumSize) & 0xFF;
  sealPage(page.data(), 1);
  return page;
}

void sealPage(std::uint8_t* page, std::uint32_t number) {
  const std::uint32_t checksum = pageChecksum(page, number);
  std::memcpy(page + kPageSize - kPageChecksumSize, &checksum, kPageChecksumSize);
}

bool pageIsIntact(const std::uint8_t* page, std::uint32_t number) {
  std::uint32_t stored = 0;
  std::memcpy(&stored, page + kPageSize - kPageChecksumSize, kPageChecksumSize);
  if (stored == pageChecksum(page, number)) {
    return true;
  }
  return std::all_of(page, page + kPageSize, [](std::uint8_t byte) { return byte == 0; });
}

}  // namespace perennial
