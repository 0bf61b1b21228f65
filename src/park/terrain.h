#pragma once

#include <opencv2/core.hpp>
#include <osg/Group>

#include "perennial/park/loop_path.h"
#include "perennial/park/season.h"

namespace perennial::park {

/// The ground: level near the path, gently rolling further off, with the gravel path on it.
class Terrain {
 public:
  explicit Terrain(const LoopPath& path);

  /// m, above the level of the path.
  double height(double x, double y) const;
  /// From the middle of the path, m; at most 5 m is told apart.
  double distanceToPath(double x, double y) const;

  /// The square that the path's picture covers: south-west corner (m) and side (m).
  cv::Point2d origin() const { return origin_; }
  static constexpr double kSideM = 44.0;
  static constexpr double kLargestDistanceM = 5.0;
  /// Distance to the path, CV_8UC1, 255 at kLargestDistanceM; row 0 in the south.
  const cv::Mat& distancePicture() const { return picture_; }

  osg::ref_ptr<osg::Geometry> ground() const;
  /// Blades of grass and weeds beside the path, in cells that vanish further off.
  osg::ref_ptr<osg::Group> grass(const Season& season, int seed) const;

 private:
  osg::ref_ptr<osg::Geometry> grassCell(double x, double y, double side_m, const Season& season,
                                        int seed) const;

  cv::Point2d origin_;
  cv::Mat picture_;
};

}  // namespace perennial::park
