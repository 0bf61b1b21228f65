#pragma once

#include <vector>

#include "perennial/park/pose.h"

namespace perennial::park {

struct LoopSettings {
  double length_m = 33.0;  ///< of the whole loop
  int shape_seed = 0;      ///< 0: the standard shape; others move its corners by up to 0.3 m
};

/// A closed path made of straights and arcs: an L with rounded corners, driven counter-clockwise, so that it
/// has left curves and one right curve. It starts at the origin along x, in the middle of the longest
/// straight. Arc lengths are taken modulo the length.
class LoopPath {
 public:
  explicit LoopPath(const LoopSettings& settings = {});

  struct Nearest {
    double arc_length_m = 0.0;
    double lateral_m = 0.0;  ///< of the point from the path, positive to the left
  };

  double length() const { return length_m_; }
  Pose at(double arc_length_m) const;
  /// 1/m, positive where the path turns left.
  double curvature(double arc_length_m) const;
  /// Nearest point of the whole loop.
  Nearest nearest(double x, double y) const;
  /// Nearest point within `window_m` of a known arc length, for following the path.
  Nearest nearest(double x, double y, double arc_length_m, double window_m) const;

 private:
  /// A straight (curvature 0) or an arc.
  struct Piece {
    double start_m = 0.0;
    double length_m = 0.0;
    double curvature = 0.0;
    Pose start;
  };

  const Piece& pieceAt(double arc_length_m) const;
  Nearest lateralAt(double x, double y, double arc_length_m) const;
  Nearest refined(double x, double y, double begin_m, double end_m) const;

  std::vector<Piece> pieces_;
  double length_m_ = 0.0;
};

}  // namespace perennial::park
