#include "faulty_vfs.h"

#include <sqlite3.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace perennial {
namespace {

constexpr sqlite3_int64 kSector = 512;

/// What a sector held before it was written.
struct Undo {
  sqlite3_int64 offset = 0;
  std::vector<char> before;  // shorter than the sector where the file ended
};

struct File {
  sqlite3_file base;
  sqlite3_file* real;
  std::string* path;  // nullptr: not to be touched
};

sqlite3_vfs* platform = nullptr;
std::map<std::string, std::vector<Undo>> unsynced;  // by path, in the order of writing
std::vector<File*> open_files;

File* fileOf(sqlite3_file* file) { return reinterpret_cast<File*>(file); }
sqlite3_file* real(sqlite3_file* file) { return fileOf(file)->real; }

void remember(File* file, sqlite3_int64 offset, sqlite3_int64 amount) {
  sqlite3_int64 size = 0;
  file->real->pMethods->xFileSize(file->real, &size);
  for (sqlite3_int64 at = offset; at < offset + amount; at = (at / kSector + 1) * kSector) {
    const sqlite3_int64 end = std::min((at / kSector + 1) * kSector, offset + amount);
    const sqlite3_int64 there = std::clamp<sqlite3_int64>(size - at, 0, end - at);
    Undo undo{at, std::vector<char>(static_cast<std::size_t>(there))};
    if (there > 0) {
      file->real->pMethods->xRead(file->real, undo.before.data(), static_cast<int>(there), at);
    }
    undo.before.resize(static_cast<std::size_t>(end - at), '\0');
    unsynced[*file->path].push_back(std::move(undo));
  }
}

/// Each unsynced sector is lost with even odds, those written last first.
void loseSectors(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  for (File* file : open_files) {
    std::vector<Undo>& undos = unsynced[*file->path];
    for (auto undo = undos.rbegin(); undo != undos.rend(); ++undo) {
      if (random() % 2 == 0) {
        file->real->pMethods->xWrite(file->real, undo->before.data(), static_cast<int>(undo->before.size()),
                                     undo->offset);
      }
    }
  }
  unsynced.clear();
}

}  // namespace

struct FaultyDiskMethods {
  static FaultyDisk& disk() { return FaultyDisk::instance(); }

  /// SQLITE_OK for files that are not to be touched.
  static int event(const std::string* path) { return path == nullptr ? SQLITE_OK : disk().next(); }

  static int close(sqlite3_file* file) {
    const int result = real(file)->pMethods->xClose(real(file));
    open_files.erase(std::remove(open_files.begin(), open_files.end(), fileOf(file)), open_files.end());
    delete fileOf(file)->path;
    sqlite3_free(real(file));
    return result;
  }
  static int read(sqlite3_file* file, void* buffer, int amount, sqlite3_int64 offset) {
    if (fileOf(file)->path != nullptr) {
      ++disk().reads_;
      if (disk().power_is_lost_) {
        return SQLITE_IOERR_READ;
      }
    }
    return real(file)->pMethods->xRead(real(file), buffer, amount, offset);
  }
  static int write(sqlite3_file* file, const void* buffer, int amount, sqlite3_int64 offset) {
    const std::string* path = fileOf(file)->path;
    const bool loses_power = path != nullptr && disk().events_ + 1 == disk().lose_power_at_;
    if (path != nullptr && !disk().power_is_lost_) {
      remember(fileOf(file), offset, amount);
    }
    if (loses_power) {  // written like the others, then partly lost like the others
      real(file)->pMethods->xWrite(real(file), buffer, amount, offset);
    }
    const int result = event(path);
    return result == SQLITE_OK ? real(file)->pMethods->xWrite(real(file), buffer, amount, offset) : result;
  }
  static int truncate(sqlite3_file* file, sqlite3_int64 size) {
    const int result = event(fileOf(file)->path);
    return result == SQLITE_OK ? real(file)->pMethods->xTruncate(real(file), size) : result;
  }
  static int sync(sqlite3_file* file, int flags) {
    const int result = event(fileOf(file)->path);
    if (result == SQLITE_OK && fileOf(file)->path != nullptr) {
      unsynced.erase(*fileOf(file)->path);
    }
    return result == SQLITE_OK ? real(file)->pMethods->xSync(real(file), flags) : result;
  }
  static int size(sqlite3_file* file, sqlite3_int64* bytes) {
    return real(file)->pMethods->xFileSize(real(file), bytes);
  }
  static int lock(sqlite3_file* file, int level) { return real(file)->pMethods->xLock(real(file), level); }
  static int unlock(sqlite3_file* file, int level) {
    return real(file)->pMethods->xUnlock(real(file), level);
  }
  static int reserved(sqlite3_file* file, int* result) {
    return real(file)->pMethods->xCheckReservedLock(real(file), result);
  }
  static int control(sqlite3_file* file, int operation, void* argument) {
    return real(file)->pMethods->xFileControl(real(file), operation, argument);
  }
  static int sector(sqlite3_file* file) { return real(file)->pMethods->xSectorSize(real(file)); }
  static int device(sqlite3_file* file) { return real(file)->pMethods->xDeviceCharacteristics(real(file)); }

  static const sqlite3_io_methods* table() {
    static const sqlite3_io_methods methods = {1,       close,   read,     write,   truncate, sync,   size,
                                               lock,    unlock,  reserved, control, sector,   device, nullptr,
                                               nullptr, nullptr, nullptr,  nullptr, nullptr};
    return &methods;
  }

  static int open(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* flags_out) {
    File* ours = fileOf(file);
    ours->base.pMethods = nullptr;
    ours->path = nullptr;
    ours->real = static_cast<sqlite3_file*>(sqlite3_malloc(platform->szOsFile));
    std::memset(ours->real, 0, static_cast<std::size_t>(platform->szOsFile));
    const int result = platform->xOpen(platform, name, ours->real, flags, flags_out);
    if (result != SQLITE_OK) {
      sqlite3_free(ours->real);
      return result;
    }
    if (name != nullptr && (flags & SQLITE_OPEN_DELETEONCLOSE) == 0) {
      ours->path = new std::string(name);
      open_files.push_back(ours);
    }
    ours->base.pMethods = table();
    return SQLITE_OK;
  }
  static int remove(sqlite3_vfs*, const char* name, int sync_folder) {
    const int result = disk().next();
    if (result != SQLITE_OK) {
      return result;
    }
    unsynced.erase(name);
    return platform->xDelete(platform, name, sync_folder);
  }
  static int access(sqlite3_vfs*, const char* name, int flags, int* result) {
    return platform->xAccess(platform, name, flags, result);
  }
  static int fullPathname(sqlite3_vfs*, const char* name, int length, char* result) {
    return platform->xFullPathname(platform, name, length, result);
  }
  static int randomness(sqlite3_vfs*, int length, char* result) {
    return platform->xRandomness(platform, length, result);
  }
  static int pause(sqlite3_vfs*, int microseconds) { return platform->xSleep(platform, microseconds); }
  static int currentTime(sqlite3_vfs*, double* days) { return platform->xCurrentTime(platform, days); }
  static int lastError(sqlite3_vfs*, int length, char* text) {
    return platform->xGetLastError(platform, length, text);
  }
};

FaultyDisk& FaultyDisk::instance() {
  static FaultyDisk disk;
  static sqlite3_vfs vfs{};
  if (platform == nullptr) {
    platform = sqlite3_vfs_find(nullptr);
    vfs.iVersion = 1;
    vfs.szOsFile = static_cast<int>(sizeof(File));
    vfs.mxPathname = platform->mxPathname;
    vfs.zName = "faulty-disk";
    vfs.xOpen = FaultyDiskMethods::open;
    vfs.xDelete = FaultyDiskMethods::remove;
    vfs.xAccess = FaultyDiskMethods::access;
    vfs.xFullPathname = FaultyDiskMethods::fullPathname;
    vfs.xRandomness = FaultyDiskMethods::randomness;
    vfs.xSleep = FaultyDiskMethods::pause;
    vfs.xCurrentTime = FaultyDiskMethods::currentTime;
    vfs.xGetLastError = FaultyDiskMethods::lastError;
    if (sqlite3_vfs_register(&vfs, 1) != SQLITE_OK) {
      throw std::runtime_error("the faulty disk cannot be registered");
    }
  }
  return disk;
}

void FaultyDisk::reset() {
  events_ = 0;
  reads_ = 0;
  fail_from_ = 0;
  lose_power_at_ = 0;
  power_is_lost_ = false;
  unsynced.clear();
}

void FaultyDisk::failFrom(std::size_t event, int code) {
  reset();
  fail_from_ = event;
  code_ = code;
}

void FaultyDisk::losePowerAt(std::size_t event, std::uint64_t seed) {
  reset();
  lose_power_at_ = event;
  seed_ = seed;
}

int FaultyDisk::next() {
  if (power_is_lost_) {
    return SQLITE_IOERR;
  }
  ++events_;
  if (events_ == lose_power_at_) {
    power_is_lost_ = true;
    loseSectors(seed_);
    return SQLITE_IOERR;
  }
  return fail_from_ != 0 && events_ >= fail_from_ ? code_ : SQLITE_OK;
}

}  // namespace perennial
