#pragma once

#include <sys/time.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <thread>

#include "perennial/ros/drivers/tara_world.h"

namespace perennial {

/// A V4L2 device that streams the pictures of a TaraWorld as Y16, for tara_preload. Thread-safe.
class TaraSimulatedVideo {
 public:
  explicit TaraSimulatedVideo(TaraWorld& world);
  /// Does not close descriptor(), whose end brought this about.
  ~TaraSimulatedVideo();
  TaraSimulatedVideo(const TaraSimulatedVideo&) = delete;
  TaraSimulatedVideo& operator=(const TaraSimulatedVideo&) = delete;

  int descriptor() const { return event_; }
  int memory() const { return memory_; }

  /// An ioctl on the device: 0, or -1 with errno.
  int control(unsigned long request, void* argument);

 private:
  static constexpr std::uint32_t kBuffers = 4;
  struct Filled {
    std::uint32_t index;
    std::uint32_t size;
    std::uint32_t sequence;
    timeval stamp;
  };
  int describe(void* argument) const;
  int setFormat(void* argument) const;
  int setRate(void* argument);
  int queryBuffer(void* argument) const;
  int queue(void* argument);
  int dequeue(void* argument);
  int setControl(void* argument);
  void run();
  bool waitForPicture(std::uint64_t& shown) const;
  void fill();
  std::uint32_t frameSize() const { return 2 * world_.width * world_.height; }

  TaraWorld& world_;
  int event_;
  int memory_;
  std::uint8_t* buffers_;
  std::uint32_t buffer_size_;  ///< a multiple of the page size
  std::atomic<bool> end_{false};
  std::atomic<bool> streaming_{false};
  std::atomic<std::int64_t> period_us_{33333};
  std::mutex mutex_;
  std::deque<std::uint32_t> queued_;
  std::deque<Filled> filled_;
  std::uint32_t sequence_ = 0;
  std::thread thread_;
};

}  // namespace perennial
