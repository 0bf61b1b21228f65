#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace perennial {

/// What of a folder's files is not yet for certain on the disk, and what a power failure makes of it. Of each
/// file: what was written since its last sync. Of the folder: which names were given and taken since its own
/// last sync. Told of every change before it is made. The folder's files lie in it directly, and beside it
/// there must be an empty folder `<folder>.limbo` for those that lost their names. One thread.
class UnsyncedChanges {
 public:
  explicit UnsyncedChanges(const std::string& folder);
  ~UnsyncedChanges();
  UnsyncedChanges(const UnsyncedChanges&) = delete;
  UnsyncedChanges& operator=(const UnsyncedChanges&) = delete;

  /// Of the folder's own, or the folder itself.
  bool concerns(int descriptor) const;
  bool concerns(const std::string& path) const;

  void willWrite(int descriptor, off_t offset, std::size_t size);
  void willTruncate(int descriptor, off_t size);
  void willCreate(const std::string& path);
  void willUnlink(const std::string& path);
  void willLink(const std::string& to) { willCreate(to); }
  void willRename(const std::string& from, const std::string& to);
  void synced(int descriptor);
  /// How many names were given and taken; and of those noted since, that the calls failed.
  std::size_t names() const { return undo_names_.size(); }
  void forgetNames(std::size_t names) { undo_names_.resize(names); }

  /// The power fails: of what was written each sector of 512 bytes is on the disk or not, by chance, and a
  /// file that grew may be shorter; of the names those given and taken last are as before, by chance how
  /// many: file systems with a journal keep their order.
  void lose(std::uint64_t seed);
  /// The same for what was written to one file: the kernel drops what it could not write, and later syncs
  /// succeed without it.
  void loseContent(int descriptor, std::uint64_t seed);

 private:
  using FileId = std::pair<dev_t, ino_t>;
  struct Undo {
    off_t offset = 0;
    std::vector<char> before;
  };
  struct File {
    int descriptor = -1;  // of our own; closing it would drop the locks that the process holds on the file
    off_t synced_size = 0;
    std::vector<Undo> undos;
  };

  static FileId idOf(int descriptor);
  static void loseSectors(const File& file, std::mt19937_64& random);
  File& fileOf(int descriptor);
  std::string limbo();

  std::string folder_;
  std::map<FileId, File> files_;
  std::vector<std::function<void()>> undo_names_;
  int in_limbo_ = 0;
};

}  // namespace perennial
