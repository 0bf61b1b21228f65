#pragma once

#include <unistd.h>

#include <chrono>
#include <cstddef>
#include <string>

namespace perennial {

/// A bar with the time left on a terminal, a line every tenth of the way elsewhere; both on stderr.
class Progress {
 public:
  Progress(std::string what, std::size_t total) : what_(std::move(what)), total_(total) {}

  /// To be called by one thread at a time.
  void show(std::size_t done);

 private:
  std::string what_;
  std::size_t total_;
  int shown_percent_ = 0;
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace perennial
