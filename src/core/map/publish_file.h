#pragma once

#include <string>

namespace perennial {

/// False also when one must not look.
bool fileExists(const std::string& file);

/// A file that is being written under another name, with an advisory lock (flock) that tells a live one from
/// one that a crash left behind. Throws MapError.
class PartialFile {
 public:
  /// Creates `<final_file>.partial`, empty, and its folder. One left behind by a crash is replaced; one that
  /// another program is writing, or that is a complete map which could not be given its name, is refused.
  explicit PartialFile(const std::string& final_file);
  /// Removes the file unless it was published or kept.
  ~PartialFile();
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  const std::string& path() const { return path_; }
  void append(const void* bytes, std::size_t size);

  /// From now on the file is worth keeping, whatever happens.
  void keep() { remove_ = false; }

  /// Syncs, gives the file its final name in one step, and syncs the folder. Without `overwrite`, a file that
  /// has the name already stays and the error says where the new one is; there is no moment at which it could
  /// be replaced.
  void publish(bool overwrite);

 private:
  void lock();

  std::string final_;
  std::string path_;
  int descriptor_ = -1;
  bool remove_ = true;
};

}  // namespace perennial
