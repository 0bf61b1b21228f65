#include "tools/evaluate/progress.h"

#include <algorithm>
#include <cstdio>

namespace perennial {

void Progress::show(std::size_t done) {
  const auto percent = static_cast<int>(100 * done / std::max<std::size_t>(total_, 1));
  if (percent == shown_percent_ || (!terminal_ && percent / 10 == shown_percent_ / 10)) {
    return;
  }
  shown_percent_ = percent;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  const double left_s = elapsed.count() * static_cast<double>(total_ - done) / static_cast<double>(done);
  const std::string bar(static_cast<std::size_t>(percent) / 4, '#');
  std::fprintf(stderr, "%s%-22s [%-25s] %3d %%, %.0f s left%s", terminal_ ? "\r" : "", what_.c_str(),
               bar.c_str(), percent, left_s, terminal_ && done < total_ ? "   " : "\n");
}

}  // namespace perennial
