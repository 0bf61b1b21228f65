#pragma once

#include <vector>

#include "core/registration/edge_correlation.h"

namespace perennial {

/// One weighted vote for a displacement.
struct Vote {
  double displacement_px = 0.0;
  double weight = 0.0;
};

/// Peak of smoothed votes.
struct VotePeak {
  double displacement_px = 0.0;  ///< refined to a fraction of a pixel
  double width_px =
      0.0;              ///< deviation of the votes about it, those at 2 kernels' distance and beyond left out
  double height = 0.0;  ///< sum of weights, each times the Gaussian kernel at its distance
  double second_height = 0.0;  ///< of the highest place elsewhere: beyond kElsewhere_px
};

/// Weighted votes along one axis, smoothed by a Gaussian. Symmetric: mirrored votes give the mirrored peak.
class VoteProfile {
 public:
  static constexpr double kKernel_px =
      15.0;  ///< deviation of the Gaussian: annotation, parallax, matching together
  static constexpr double kElsewhere_px = 50.0;

  /// What the edges say (EdgeCorrelation), in votes a deviation.
  static constexpr double kEdgeWeight = 6.0;

  /// `votes` must not be empty. With `edges` the highest place of votes and edges together is the peak; the
  /// votes around it say where exactly. Memory is kept and used again.
  VotePeak findPeak(const std::vector<Vote>& votes, const EdgeCorrelation* edges = nullptr);

 private:
  void collect(const std::vector<Vote>& votes, double reach_px);
  void smooth();
  void add(const EdgeCorrelation& edges);
  int highest() const;

  int half_ = 0;              ///< bins on either side of the middle one
  std::vector<double> bins_;  ///< of votes, and empty ones as far as the kernel reaches
  std::vector<double> smoothed_;
};

}  // namespace perennial
