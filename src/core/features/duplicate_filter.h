#pragma once

#include <vector>

#include "perennial/core/feature.h"

namespace perennial {

/// A maximum after refinement.
struct Candidate {
  Keypoint keypoint;
  int octave = 0;
};

/// Recognises a blob that was found in two octaves.
///
/// Neighbouring octaves overlap by one filter size, and each finds a blob of about that size, with nearly the
/// same position and scale. Candidates are offered strongest first; one is a duplicate when an accepted one
/// of another octave is no further away than the coarser octave's sampling step, and no more than 1.4 times
/// larger or smaller (the ratio of neighbouring filter sizes at the bottom of an octave, 15 to 21). Maxima of
/// the same octave are never duplicates: suppression among neighbours keeps them apart.
class DuplicateFilter {
 public:
  /// Forgets everything, for an image of this size. Memory is kept and used again.
  void reset(int columns, int rows, int octaves);

  /// True, and remembered, unless it is a duplicate of one accepted before.
  bool accept(const Candidate& candidate);

 private:
  bool isDuplicate(const Candidate& candidate) const;

  int cell_px_ =
      1;  ///< at least the coarsest step, so that duplicates are in the same or a neighbouring cell
  int cells_x_ = 0;
  int cells_y_ = 0;
  std::vector<int> heads_;  ///< per cell, its newest candidate, or -1
  std::vector<int> nexts_;  ///< per accepted candidate, the one before it in the same cell, or -1
  std::vector<Candidate> accepted_;
};

}  // namespace perennial
