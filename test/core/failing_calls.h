#pragma once

#include <cstddef>

namespace perennial {

/// System calls that change files, made to fail by the program that this is linked into: write, pwrite,
/// fsync, ftruncate, fchmod, link, rename, unlink, wherever they are called from. Numbered from 1 since
/// `arm`. One thread.
class FailingCalls {
 public:
  enum class How {
    kFail,     ///< this call fails as on a full disk
    kDie,      ///< the process ends at once, as by kill -9, before this call
    kCorrupt,  ///< writes another byte somewhere in the middle, says nothing, and goes on
    kNoRoom,   ///< every file system has no room left, by its own account; no number counts
    kNoLinks,  ///< every link() fails, as on a file system without hard links; no number counts
  };
  static void arm(How how, std::size_t call);
  static void disarm();
  /// Calls since `arm`.
  static std::size_t calls();
  /// Of them, those that wrote something.
  static bool hasCorrupted();
};

}  // namespace perennial
