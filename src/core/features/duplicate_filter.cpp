#include "core/features/duplicate_filter.h"

#include <algorithm>

namespace perennial {
namespace {

constexpr float kSameScale = 1.4F;
constexpr int kSmallestCell = 16;  // px; a few candidates a cell

bool sameBlob(const Candidate& a, const Candidate& b) {
  if (a.octave == b.octave) {
    return false;
  }
  const auto step = static_cast<float>(1 << std::max(a.octave, b.octave));
  const float dx = a.keypoint.x - b.keypoint.x;
  const float dy = a.keypoint.y - b.keypoint.y;
  return dx * dx + dy * dy <= step * step && a.keypoint.scale <= kSameScale * b.keypoint.scale &&
         b.keypoint.scale <= kSameScale * a.keypoint.scale;
}

}  // namespace

void DuplicateFilter::reset(int columns, int rows, int octaves) {
  cell_px_ = std::max(kSmallestCell, 1 << (octaves - 1));
  cells_x_ = columns / cell_px_ + 1;
  cells_y_ = rows / cell_px_ + 1;
  heads_.assign(static_cast<std::size_t>(cells_x_) * static_cast<std::size_t>(cells_y_), -1);
  nexts_.clear();
  accepted_.clear();
}

bool DuplicateFilter::accept(const Candidate& candidate) {
  if (isDuplicate(candidate)) {
    return false;
  }
  const int x = static_cast<int>(candidate.keypoint.x) / cell_px_;
  const int y = static_cast<int>(candidate.keypoint.y) / cell_px_;
  int& head = heads_[static_cast<std::size_t>(y * cells_x_ + x)];
  nexts_.push_back(head);
  head = static_cast<int>(accepted_.size());
  accepted_.push_back(candidate);
  return true;
}

bool DuplicateFilter::isDuplicate(const Candidate& candidate) const {
  const int x = static_cast<int>(candidate.keypoint.x) / cell_px_;
  const int y = static_cast<int>(candidate.keypoint.y) / cell_px_;
  for (int cy = std::max(y - 1, 0); cy <= std::min(y + 1, cells_y_ - 1); ++cy) {
    for (int cx = std::max(x - 1, 0); cx <= std::min(x + 1, cells_x_ - 1); ++cx) {
      int i = heads_[static_cast<std::size_t>(cy * cells_x_ + cx)];
      for (; i >= 0; i = nexts_[static_cast<std::size_t>(i)]) {
        if (sameBlob(candidate, accepted_[static_cast<std::size_t>(i)])) {
          return true;
        }
      }
    }
  }
  return false;
}

}  // namespace perennial
