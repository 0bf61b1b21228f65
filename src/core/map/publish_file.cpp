#include "core/map/publish_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>

#include "core/map/checksum_vfs.h"
#include "core/map/map_schema.h"
#include "core/map/sqlite.h"
#include "perennial/core/error.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPartialSuffix = ".partial";
constexpr const char* kCopySuffix = ".copy";
constexpr int kPatienceMs = 500;  // for a map that is to be replaced, and that somebody is just reading

std::string systemError() { return std::strerror(errno); }

fs::path folderOf(const std::string& file) {
  const fs::path folder = fs::path(file).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

/// Whether a partial file is complete (completeMap()): SQLite's application_id and user_version stand
/// big-endian at 68 and 60.
bool isFinishedMap(int descriptor) {
  Page first{};
  if (::pread(descriptor, first.data(), first.size(), 0) != static_cast<ssize_t>(first.size()) ||
      !pageIsIntact(first.data(), 1)) {
    return false;
  }
  const auto bigEndian = [&first](std::size_t i) {
    return std::uint32_t{first[i]} << 24 | std::uint32_t{first[i + 1]} << 16 |
           std::uint32_t{first[i + 2]} << 8 | std::uint32_t{first[i + 3]};
  };
  return bigEndian(68) == kMapApplicationId && bigEndian(60) > 0;
}

bool isSameFile(int descriptor, const std::string& path) {
  struct stat opened {};
  struct stat named {};
  return ::fstat(descriptor, &opened) == 0 && ::stat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

/// rename() that fails with EEXIST instead of replacing a file.
bool renameNew(const std::string& from, const std::string& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) {
    return true;
  }
  if (errno != EINVAL && errno != ENOSYS) {
    return false;
  }
  // The file system cannot; link() does not replace either.
  return ::link(from.c_str(), to.c_str()) == 0 && ::unlink(from.c_str()) == 0;
}

/// SQLite would take the journal of an earlier file of this name for the new file's, and destroy it.
void removeJournal(const std::string& file) { ::unlink((file + "-journal").c_str()); }

/// A map that is to be replaced, held so that no program is using it meanwhile. A damaged one need not be.
std::optional<Database> heldForReplacement(const std::string& file) {
  if (!fileExists(file)) {
    return std::nullopt;
  }
  try {
    Database database = Database::openMap(file);
    database.setPatience(kPatienceMs);
    database.execute("BEGIN EXCLUSIVE");
    return database;
  } catch (const SqliteError& error) {
    if (error.code() == SQLITE_BUSY) {
      throw MapError("map '" + file +
                     "' cannot be replaced while another program is using it: stop that first");
    }
  }
  return std::nullopt;
}

}  // namespace

bool fileExists(const std::string& file) {
  std::error_code problem;
  return fs::exists(file, problem);
}

void syncFolder(const std::string& file) {
  const int folder = ::open(folderOf(file).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool synced = folder >= 0 && ::fsync(folder) == 0;
  const std::string problem = systemError();
  if (folder >= 0) {
    ::close(folder);
  }
  if (!synced) {
    throw MapError("folder " + folderOf(file).string() + " cannot be synced to the disk: " + problem +
                   ". Check the disk");
  }
}

PartialFile::PartialFile(const std::string& final_file, Content content)
    : final_(final_file), path_(final_file + (content == Content::kCopy ? kCopySuffix : kPartialSuffix)) {
  std::error_code problem;
  fs::create_directories(folderOf(final_file), problem);
  if (problem) {
    throw MapError("folder " + folderOf(final_file).string() + " cannot be created: " + problem.message() +
                   ". Choose another map folder or change its permissions");
  }
  lock();
  if (content == Content::kNewMap && isFinishedMap(descriptor_)) {
    ::close(descriptor_);
    throw MapError("'" + path_ +
                   "' holds a finished map that could not be given its name: move or remove it first");
  }
  if (::ftruncate(descriptor_, 0) != 0) {
    const std::string reason = systemError();
    ::close(descriptor_);
    throw MapError("'" + path_ + "' cannot be written: " + reason);
  }
}

void PartialFile::lock() {
  do {
    if (descriptor_ >= 0) {
      ::close(descriptor_);
    }
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor_ < 0) {
      throw MapError("'" + path_ + "' cannot be created: " + systemError() +
                     ". Choose another map folder or change its permissions");
    }
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      ::close(descriptor_);
      throw MapError("'" + path_ +
                     "' is being written by another program: wait for it, or choose another name");
    }
    // Between opening and locking, the file may have been given its final name by the one that wrote it.
  } while (!isSameFile(descriptor_, path_));
}

PartialFile::~PartialFile() {
  if (remove_) {
    ::unlink(path_.c_str());
  }
  ::close(descriptor_);
}

void PartialFile::append(const void* bytes, std::size_t size) {
  if (::write(descriptor_, bytes, size) != static_cast<ssize_t>(size)) {
    throw MapError("'" + path_ + "' cannot be written: " + systemError() +
                   ". Free some space, or check the disk");
  }
}

void PartialFile::sync() {
  if (sync_failed_ || ::fsync(descriptor_) != 0) {
    const std::string reason = sync_failed_ ? "that has failed before" : systemError();
    sync_failed_ = true;
    throw MapError("'" + path_ + "' cannot be synced to the disk: " + reason +
                   ". Free some space, or check the disk");
  }
}

void PartialFile::publish(bool overwrite) {
  sync();
  if (!overwrite && fileExists(final_)) {
    throw MapError("'" + final_ + "' exists already and is kept; the new map is complete in '" + path_ + "'");
  }
  const std::optional<Database> replaced = heldForReplacement(final_);
  rename(overwrite);
}

void PartialFile::replaceLocked() {
  struct stat replaced {};
  if (::stat(final_.c_str(), &replaced) != 0 || ::fchmod(descriptor_, replaced.st_mode & 07777) != 0) {
    throw MapError("'" + path_ + "' cannot be given the permissions of '" + final_ + "': " + systemError());
  }
  sync();
  rename(true);
}

void PartialFile::rename(bool overwrite) {
  removeJournal(final_);
  const bool renamed = overwrite ? std::rename(path_.c_str(), final_.c_str()) == 0 : renameNew(path_, final_);
  if (!renamed) {
    const std::string problem = systemError();
    throw MapError("'" + final_ + "' cannot be given its name: " + problem +
                   (remove_ ? "" : "; the new map is complete in '" + path_ + "'"));
  }
  remove_ = false;
  published_ = true;
  syncFolder(final_);
}

}  // namespace perennial
