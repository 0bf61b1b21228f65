#pragma once

#include <atomic>
#include <cstdint>
#include <string>

namespace perennial {

/// What the simulated TARA sees and what is wrong with it: memory shared by the simulator node, which writes
/// it, and the preloaded library inside the camera's driver (tara_preload.cpp), which presents it as devices.
struct TaraWorld {
  static constexpr std::uint32_t kMaxPixels = 752 * 480;

  /// Pictures, double-buffered: picture n lies in slot n % 2.
  struct Picture {
    std::uint8_t left[kMaxPixels];
    std::uint8_t right[kMaxPixels];
  };
  std::uint32_t width;
  std::uint32_t height;
  /// One frame for every picture; otherwise frames at the rate that the driver asked for, whatever the
  /// pictures.
  std::atomic<std::uint32_t> triggered;
  std::atomic<std::uint64_t> picture_number;

  std::atomic<std::uint32_t> unplugged;
  std::atomic<std::uint32_t> stalled;       ///< no frame comes
  std::atomic<std::uint32_t> short_frames;  ///< so many frames lack their end
  std::atomic<std::uint32_t> hid_silent;    ///< no reply comes
  std::atomic<std::uint32_t> hid_nonsense;  ///< replies are random bytes

  // What the driver did, for tests:
  std::atomic<std::uint32_t> exposure;
  std::atomic<std::uint32_t> brightness;
  std::atomic<std::uint64_t> frames;

  Picture pictures[2];
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free, "shared between processes");

/// The simulation's folder holds `sys`, `dev` and the file `world`.
std::string taraWorldFile(const std::string& folder);

/// Maps the world of a simulation; with `create`, makes the file first. Throws Error. Never unmapped: it
/// lasts as long as the process.
TaraWorld& mapTaraWorld(const std::string& folder, bool create);

}  // namespace perennial
