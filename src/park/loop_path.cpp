#include "perennial/park/loop_path.h"

#include <algorithm>
#include <cstddef>

#include "perennial/park/random.h"

namespace perennial::park {
namespace {

struct Corner {
  double x, y;
  double radius;
};

/// An L, counter-clockwise; the fourth corner is the one that turns right. The second point of the list
/// continues the first straight, which starts in its own middle, at the first point.
std::vector<Corner> corners(int seed) {
  std::vector<Corner> list = {{5.2, 0.0, 1.9},  {5.4, 5.2, 1.9},  {0.6, 5.6, 1.8},
                              {-0.2, 9.6, 1.8}, {-5.4, 9.4, 1.9}, {-5.2, 0.0, 1.9}};
  Random random(mix({seed, 4711}));
  for (std::size_t i = 1; seed != 0 && i + 1 < list.size(); ++i) {  // The first straight stays on the x axis.
    list[i].x += random.uniform(-0.3, 0.3);
    list[i].y += random.uniform(-0.3, 0.3);
  }
  return list;
}

double directionOf(const Corner& from, const Corner& to) { return std::atan2(to.y - from.y, to.x - from.x); }

}  // namespace

LoopPath::LoopPath(const LoopSettings& settings) {
  const std::vector<Corner> list = corners(settings.shape_seed);
  Pose pose;
  const auto append = [&](double length, double curvature) {
    pieces_.push_back({length_m_, length, curvature, pose});
    pose = moved(pose, length, curvature * length);
    length_m_ += length;
  };
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Corner& corner = list[i];
    const Corner& next = list[(i + 1) % list.size()];
    const double turn = wrapAngle(directionOf(corner, next) - pose.heading);
    const double cut = corner.radius * std::tan(std::abs(turn) / 2.0);  // where the arc leaves the straight
    append(std::hypot(corner.x - pose.x, corner.y - pose.y) - cut, 0.0);
    append(corner.radius * std::abs(turn), std::copysign(1.0 / corner.radius, turn));
  }
  append(std::hypot(pose.x, pose.y), 0.0);

  const double scale = settings.length_m / length_m_;
  for (Piece& piece : pieces_) {
    piece.start_m *= scale;
    piece.length_m *= scale;
    piece.curvature /= scale;
    piece.start.x *= scale;
    piece.start.y *= scale;
  }
  length_m_ = settings.length_m;
}

Pose LoopPath::at(double arc_length_m) const {
  const double s = arc_length_m - length_m_ * std::floor(arc_length_m / length_m_);
  const Piece& piece = pieceAt(s);
  const double distance = s - piece.start_m;
  return moved(piece.start, distance, distance * piece.curvature);
}

double LoopPath::curvature(double arc_length_m) const {
  return pieceAt(arc_length_m - length_m_ * std::floor(arc_length_m / length_m_)).curvature;
}

LoopPath::Nearest LoopPath::nearest(double x, double y) const { return refined(x, y, 0.0, length_m_); }

LoopPath::Nearest LoopPath::nearest(double x, double y, double arc_length_m, double window_m) const {
  Nearest result = refined(x, y, arc_length_m - window_m, arc_length_m + window_m);
  result.arc_length_m -= length_m_ * std::floor(result.arc_length_m / length_m_);
  return result;
}

const LoopPath::Piece& LoopPath::pieceAt(double arc_length_m) const {
  const auto after = std::upper_bound(pieces_.begin() + 1, pieces_.end(), arc_length_m,
                                      [](double s, const Piece& piece) { return s < piece.start_m; });
  return *(after - 1);
}

LoopPath::Nearest LoopPath::lateralAt(double x, double y, double arc_length_m) const {
  const Pose pose = at(arc_length_m);
  const double left = -(x - pose.x) * std::sin(pose.heading) + (y - pose.y) * std::cos(pose.heading);
  return {arc_length_m, std::copysign(std::hypot(x - pose.x, y - pose.y), left)};
}

LoopPath::Nearest LoopPath::refined(double x, double y, double begin_m, double end_m) const {
  constexpr double kCoarseStepM = 0.25;
  Nearest best = lateralAt(x, y, begin_m);
  const auto improve = [&](double s) {
    const Nearest candidate = lateralAt(x, y, s);
    if (std::abs(candidate.lateral_m) < std::abs(best.lateral_m)) {
      best = candidate;
    }
  };
  for (double s = begin_m; s <= end_m; s += kCoarseStepM) {
    improve(s);
  }
  for (double step = kCoarseStepM / 2.0; step > 1e-7; step /= 2.0) {
    const double centre = best.arc_length_m;
    improve(centre - step);
    improve(centre + step);
  }
  best.arc_length_m -= length_m_ * std::floor(best.arc_length_m / length_m_);
  return best;
}

}  // namespace perennial::park
