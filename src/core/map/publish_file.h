#pragma once

#include <string>

namespace perennial {

/// False also when one must not look.
bool fileExists(const std::string& file);

/// What was created, renamed or removed in the file's folder is on the disk. Throws MapError.
void syncFolder(const std::string& file);

/// A file that is being written under another name, with an advisory lock (flock) that tells a live one from
/// one that a crash left behind. Throws MapError.
class PartialFile {
 public:
  enum class Content {
    kNewMap,  ///< in `<final_file>.partial`; a complete one left behind holds what is nowhere else
    kCopy,    ///< in `<final_file>.copy`; one left behind can be made again, however complete
  };

  /// Creates the file, empty, and its folder. One left behind by a crash is replaced; one that another
  /// program is writing, or that is a complete new map which could not be given its name, is refused.
  explicit PartialFile(const std::string& final_file, Content content = Content::kNewMap);
  /// Removes the file unless it was published or kept.
  ~PartialFile();
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  const std::string& path() const { return path_; }
  void append(const void* bytes, std::size_t size);
  /// What was written is on the disk. Once this has failed it fails for good: the kernel may have dropped
  /// what it could not write, and would call the next attempt a success.
  void sync();

  /// From now on the file is worth keeping, whatever happens.
  void keep() { remove_ = false; }

  /// Syncs, gives the file its final name in one step, and syncs the folder. Without `overwrite`, a file that
  /// has the name already stays and the error says where the new one is; there is no moment at which it could
  /// be replaced.
  void publish(bool overwrite);
  /// The same, in place of a map whose write lock the caller holds in an SQLite transaction, and goes on
  /// holding until this returns. Keeps that file's permissions. Programs that are just reading the old map go
  /// on with it.
  void replaceLocked();

  bool hasFinalName() const { return published_; }

 private:
  void lock();
  void rename(bool overwrite);

  std::string final_;
  std::string path_;
  int descriptor_ = -1;
  bool remove_ = true;
  bool published_ = false;
  bool sync_failed_ = false;
};

}  // namespace perennial
