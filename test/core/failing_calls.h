#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace perennial {

/// System calls that change files, made to fail by the program that this is linked into: write, pwrite,
/// fsync, fdatasync, ftruncate, fchmod, link, rename, unlink and open where it creates, wherever they are
/// called from. Numbered from 1 since `arm`. One thread.
class FailingCalls {
 public:
  enum class How {
    kFail,       ///< this call fails as on a full disk
    kDie,        ///< the process ends at once, as by kill -9, before this call
    kCorrupt,    ///< writes another byte somewhere in the middle, says nothing, and goes on
    kNoRoom,     ///< every file system has no room left, by its own account; no number counts
    kNoLinks,    ///< every link() fails, as on a file system without hard links; no number counts
    kLosePower,  ///< the process ends with this call, and what was not synced is lost by chance
    kFailSync,   ///< this sync fails (EIO), and what it should have brought to the disk is lost by chance;
                 ///< syncs alone are counted
  };
  static void arm(How how, std::size_t call);
  /// For kLosePower and kFailSync: only what happens to the files of this folder counts. Beside it an empty
  /// folder `<folder>.limbo` is needed.
  static void armDisk(How how, std::size_t call, const std::string& folder, std::uint64_t seed);
  static void disarm();
  /// The power fails now. With kLosePower.
  [[noreturn]] static void losePower();
  /// Calls since `arm`.
  static std::size_t calls();
  /// Of them, those that wrote something.
  static bool hasCorrupted();

  /// Exit status of a process whose power failed.
  static constexpr int kPowerLost = 0;
};

}  // namespace perennial
