#include "terrain.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <osg/LOD>
#include <vector>

#include "mesh.h"
#include "perennial/park/random.h"

namespace perennial::park {
namespace {

constexpr int kPictureSize = 704;  // 1/16 m
constexpr double kGroundReachM = 60.0;
constexpr double kGroundCellM = 2.0;

Colour mixed(const Colour& a, const Colour& b, double share) {
  return {a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share, a[2] + (b[2] - a[2]) * share};
}

/// Plants of one point: a few blades, each a triangle that leans outwards.
void addTuft(Mesh& mesh, const Vec3& root, double height_m, int blades, const Colour& colour,
             Random& random) {
  for (int i = 0; i < blades; ++i) {
    const double angle = random.uniform(0.0, 6.2832);
    const Vec3 out(std::cos(angle), std::sin(angle), 0.0);
    const Vec3 across(-out.y(), out.x(), 0.0);
    const double length = height_m * random.uniform(0.6, 1.5);
    const double width = 0.006 + 0.03 * length;
    const Vec3 base = root + out * random.uniform(0.0, 0.05);
    const Vec3 tip = base + out * (length * random.uniform(0.1, 0.7)) + Vec3(0, 0, length);
    const Colour shade = mixed({0.0, 0.0, 0.0}, colour, random.uniform(0.6, 1.3));
    const auto uv = atlasCoordinates(Tile::kPlain, 0.5, 0.5);
    const Vec3 normal(out.x() * 0.4, out.y() * 0.4, 0.9);
    mesh.triangle({base - across * width, normal, uv[0], uv[1], mixed({0, 0, 0}, shade, 0.5), 0.0},
                  {base + across * width, normal, uv[0], uv[1], mixed({0, 0, 0}, shade, 0.5), 0.0},
                  {tip, normal, uv[0], uv[1], shade, 0.4});
  }
}

}  // namespace

Terrain::Terrain(const LoopPath& path) {
  cv::Point2d low(1e9, 1e9);
  cv::Point2d high(-1e9, -1e9);
  std::vector<cv::Point2d> points;
  for (double s = 0.0; s < path.length(); s += 0.05) {
    const Pose pose = path.at(s);
    points.emplace_back(pose.x, pose.y);
    low = {std::min(low.x, pose.x), std::min(low.y, pose.y)};
    high = {std::max(high.x, pose.x), std::max(high.y, pose.y)};
  }
  origin_ = (low + high) * 0.5 - cv::Point2d(kSideM, kSideM) * 0.5;

  const double scale = kPictureSize / kSideM;
  std::vector<cv::Point> outline;
  for (const cv::Point2d& point : points) {
    const cv::Point2d pixel = (point - origin_) * scale - cv::Point2d(0.5, 0.5);
    outline.emplace_back(static_cast<int>(std::lround(pixel.x)), static_cast<int>(std::lround(pixel.y)));
  }
  cv::Mat free(kPictureSize, kPictureSize, CV_8U, cv::Scalar(255));
  cv::polylines(free, outline, true, cv::Scalar(0));
  cv::Mat distance;
  cv::distanceTransform(free, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  distance.convertTo(picture_, CV_8U, 255.0 / (kLargestDistanceM * scale));
}

double Terrain::distanceToPath(double x, double y) const {
  const cv::Point2d pixel = (cv::Point2d(x, y) - origin_) * (kPictureSize / kSideM);
  const cv::Point at(static_cast<int>(std::floor(pixel.x)), static_cast<int>(std::floor(pixel.y)));
  const bool inside = at.x >= 0 && at.y >= 0 && at.x < kPictureSize && at.y < kPictureSize;
  return inside ? picture_.at<unsigned char>(at) * kLargestDistanceM / 255.0 : kLargestDistanceM;
}

double Terrain::height(double x, double y) const {
  const cv::Point2d centre = origin_ + cv::Point2d(kSideM, kSideM) * 0.5;
  const double distance = std::hypot(x - centre.x, y - centre.y);
  const double far = std::clamp((distance - 15.0) / 18.0, 0.0, 1.0);
  return far * far *
         (0.9 + 0.8 * std::sin(x * 0.17 + 1.0) * std::cos(y * 0.14) + 0.5 * std::sin(0.11 * (x - y)));
}

osg::ref_ptr<osg::Geometry> Terrain::ground() const {
  Mesh mesh;
  const cv::Point2d centre = origin_ + cv::Point2d(kSideM, kSideM) * 0.5;
  const auto vertex = [&](double x, double y) {
    constexpr double kStep = 0.5;
    Vec3 normal((height(x - kStep, y) - height(x + kStep, y)) / (2.0 * kStep),
                (height(x, y - kStep) - height(x, y + kStep)) / (2.0 * kStep), 1.0);
    normal.normalize();
    return Mesh::Vertex{{x, y, height(x, y)}, normal, 0.0, 0.0, {1.0, 1.0, 1.0}, 0.0};
  };
  for (double x = centre.x - kGroundReachM; x < centre.x + kGroundReachM; x += kGroundCellM) {
    for (double y = centre.y - kGroundReachM; y < centre.y + kGroundReachM; y += kGroundCellM) {
      mesh.quad(vertex(x, y), vertex(x + kGroundCellM, y), vertex(x + kGroundCellM, y + kGroundCellM),
                vertex(x, y + kGroundCellM));
    }
  }
  return mesh.geometry();
}

osg::ref_ptr<osg::Group> Terrain::grass(const Season& season, int seed) const {
  constexpr double kCellM = 3.0;
  constexpr float kVisibleToM = 13.0F;
  osg::ref_ptr<osg::Group> group = new osg::Group;
  for (double x = origin_.x + 4.0; x < origin_.x + kSideM - 4.0; x += kCellM) {
    for (double y = origin_.y + 4.0; y < origin_.y + kSideM - 4.0; y += kCellM) {
      const osg::ref_ptr<osg::Geometry> cell = grassCell(x, y, kCellM, season, seed);
      if (cell) {
        osg::ref_ptr<osg::LOD> lod = new osg::LOD;
        lod->addChild(cell, 0.0F, kVisibleToM);
        group->addChild(lod);
      }
    }
  }
  return group;
}

osg::ref_ptr<osg::Geometry> Terrain::grassCell(double x, double y, double side_m, const Season& season,
                                               int seed) const {
  constexpr double kTuftsPerM2 = 11.0;
  Random random(mix({seed, std::lround(x * 100), std::lround(y * 100), 31}));
  const Colour green = mixed({0.07, 0.13, 0.025}, {0.17, 0.15, 0.06}, season.grass_dryness);
  Mesh mesh;
  for (int i = 0; i < static_cast<int>(kTuftsPerM2 * side_m * side_m); ++i) {
    const Vec3 root(x + side_m * random.uniform(), y + side_m * random.uniform(), 0.0);
    const bool weed = random.uniform() < 0.06;
    Random own(random.next());
    const double distance = distanceToPath(root.x(), root.y());
    if (distance > 0.72 && distance < kLargestDistanceM - 0.05) {
      const double height = weed ? 0.05 + season.grass_height_m * 1.6 : 0.02 + season.grass_height_m * 0.8;
      addTuft(mesh, root, height, weed ? 9 : 4, green, own);
    }
  }
  return mesh.empty() ? nullptr : mesh.geometry();
}

}  // namespace perennial::park
