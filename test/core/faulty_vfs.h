#pragma once

#include <cstddef>
#include <cstdint>

namespace perennial {

/// A disk with faults for tests of whatever stands on SQLite: a VFS that becomes SQLite's default one,
/// forwards to the platform's, counts, and fails when told to. Events that change a file (write, sync,
/// truncate, delete) are numbered from 1 since the last `reset()`. Temporary files of SQLite's own are not
/// touched. One thread.
class FaultyDisk {
 public:
  /// Becomes the default VFS at the first call, for the life of the process.
  static FaultyDisk& instance();

  /// No faults from here on; all counts 0.
  void reset();

  /// The event with this number, and every write after it, fails with this code of SQLite's (SQLITE_FULL).
  void failFrom(std::size_t event, int code);

  /// The power fails at this event: of every write since the last sync of its file, each sector of 512 bytes
  /// is on the disk or not, by chance; so is a part of the event itself. Every later operation fails until
  /// `reset()`.
  void losePowerAt(std::size_t event, std::uint64_t seed);

  std::size_t events() const { return events_; }
  std::size_t reads() const { return reads_; }
  bool powerIsLost() const { return power_is_lost_; }

 private:
  friend struct FaultyDiskMethods;
  FaultyDisk() = default;

  /// Counts an event; the code with which it must fail, or SQLITE_OK.
  int next();

  std::size_t events_ = 0;
  std::size_t reads_ = 0;
  std::size_t fail_from_ = 0;
  int code_ = 0;
  std::size_t lose_power_at_ = 0;
  std::uint64_t seed_ = 0;
  bool power_is_lost_ = false;
};

}  // namespace perennial
