#include "unsynced_changes.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace perennial {
namespace {

namespace fs = std::filesystem;

constexpr off_t kSector = 512;

off_t sizeOf(int descriptor) {
  struct stat status {};
  fstat(descriptor, &status);
  return status.st_size;
}

std::vector<char> contentOf(int descriptor, off_t offset, off_t size) {
  std::vector<char> bytes(static_cast<std::size_t>(size), '\0');  // beyond the end of the file: zeros
  if (pread(descriptor, bytes.data(), bytes.size(), offset) < 0) {
    bytes.clear();
  }
  return bytes;
}

}  // namespace

UnsyncedChanges::UnsyncedChanges(const std::string& folder) : folder_(fs::canonical(folder).string()) {}

UnsyncedChanges::~UnsyncedChanges() {
  for (const auto& [id, file] : files_) {
    ::close(file.descriptor);
  }
}

bool UnsyncedChanges::concerns(int descriptor) const {
  std::error_code problem;
  const fs::path path = fs::read_symlink("/proc/self/fd/" + std::to_string(descriptor), problem);
  return path == folder_ || path.parent_path() == folder_;
}

bool UnsyncedChanges::concerns(const std::string& path) const {
  std::error_code problem;
  return fs::canonical(fs::path(path).parent_path(), problem) == folder_;
}

UnsyncedChanges::FileId UnsyncedChanges::idOf(int descriptor) {
  struct stat status {};
  fstat(descriptor, &status);
  return {status.st_dev, status.st_ino};
}

UnsyncedChanges::File& UnsyncedChanges::fileOf(int descriptor) {
  File& file = files_[idOf(descriptor)];
  if (file.descriptor < 0) {
    file.descriptor = dup(descriptor);
    file.synced_size = sizeOf(descriptor);
  }
  return file;
}

void UnsyncedChanges::willWrite(int descriptor, off_t offset, std::size_t size) {
  File& file = fileOf(descriptor);
  const off_t end = offset + static_cast<off_t>(size);
  for (off_t at = offset; at < end; at = (at / kSector + 1) * kSector) {
    const off_t next = std::min((at / kSector + 1) * kSector, end);
    file.undos.push_back({at, contentOf(file.descriptor, at, next - at)});
  }
}

void UnsyncedChanges::willTruncate(int descriptor, off_t size) {
  File& file = fileOf(descriptor);
  const off_t now = sizeOf(descriptor);
  if (size < now) {
    file.undos.push_back({size, contentOf(file.descriptor, size, now - size)});
  }
}

void UnsyncedChanges::willCreate(const std::string& path) {
  undo_names_.emplace_back([path] { ::unlink(path.c_str()); });
}

std::string UnsyncedChanges::limbo() { return folder_ + ".limbo/" + std::to_string(++in_limbo_); }

void UnsyncedChanges::willUnlink(const std::string& path) {
  const std::string kept = limbo();
  if (::link(path.c_str(), kept.c_str()) == 0) {
    undo_names_.emplace_back([path, kept] { std::rename(kept.c_str(), path.c_str()); });
  }
}

void UnsyncedChanges::willRename(const std::string& from, const std::string& to) {
  const std::string kept = limbo();
  const bool replaces = ::link(to.c_str(), kept.c_str()) == 0;
  undo_names_.emplace_back([from, to, kept, replaces] {
    std::rename(to.c_str(), from.c_str());
    if (replaces) {
      std::rename(kept.c_str(), to.c_str());
    }
  });
}

void UnsyncedChanges::synced(int descriptor) {
  struct stat status {};
  fstat(descriptor, &status);
  if (S_ISDIR(status.st_mode)) {
    undo_names_.clear();
    return;
  }
  File& file = fileOf(descriptor);
  file.undos.clear();
  file.synced_size = status.st_size;
}

void UnsyncedChanges::loseSectors(const File& file, std::mt19937_64& random) {
  for (auto undo = file.undos.rbegin(); undo != file.undos.rend(); ++undo) {
    if (random() % 2 == 0 &&
        pwrite(file.descriptor, undo->before.data(), undo->before.size(), undo->offset) < 0) {
      std::perror("undoing a write");
    }
  }
  const off_t grown = sizeOf(file.descriptor) - file.synced_size;
  if (grown > 0 && random() % 2 == 0) {
    const off_t left = static_cast<off_t>(random() % static_cast<std::uint64_t>(grown + 1));
    if (ftruncate(file.descriptor, file.synced_size + left) != 0) {
      std::perror("undoing growth");
    }
  }
}

void UnsyncedChanges::lose(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  for (const auto& [id, file] : files_) {
    loseSectors(file, random);
  }
  const std::size_t kept = random() % (undo_names_.size() + 1);
  for (std::size_t i = undo_names_.size(); i > kept; --i) {
    undo_names_[i - 1]();
  }
}

void UnsyncedChanges::loseContent(int descriptor, std::uint64_t seed) {
  const auto known = files_.find(idOf(descriptor));
  if (known != files_.end()) {
    std::mt19937_64 random(seed);
    loseSectors(known->second, random);
    known->second.undos.clear();
    known->second.synced_size = sizeOf(descriptor);
  }
}

}  // namespace perennial
