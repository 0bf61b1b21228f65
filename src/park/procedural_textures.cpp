#include "perennial/park/procedural_textures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>

#include "perennial/park/random.h"

namespace perennial::park {
namespace {

/// Noise of several octaves that repeats seamlessly, CV_8UC1 around 128.
cv::Mat softNoise(int size, int cells, int octaves, std::uint64_t seed) {
  Random random(seed);
  cv::Mat sum = cv::Mat::zeros(size, size, CV_32F);
  float amplitude = 80.0F;
  for (int octave = 0; octave < octaves; ++octave, cells *= 2, amplitude *= 0.55F) {
    cv::Mat grid(cells, cells, CV_32F);
    for (int i = 0; i < cells * cells; ++i) {
      grid.at<float>(i / cells, i % cells) = static_cast<float>(random.uniform(-1.0, 1.0));
    }
    cv::Mat wrapped;
    cv::copyMakeBorder(grid, wrapped, 2, 2, 2, 2, cv::BORDER_WRAP);
    const int cell = size / cells;
    cv::resize(wrapped, wrapped, cv::Size(), cell, cell, cv::INTER_CUBIC);
    sum += amplitude * wrapped(cv::Rect(2 * cell, 2 * cell, size, size));
  }
  cv::Mat result;
  sum.convertTo(result, CV_8U, 1.0, 128.0);
  return result;
}

/// Calls `paint` with the offsets at which something at (x, y) must be drawn so that the texture repeats
/// seamlessly.
void paintWrapped(int size, double x, double y, double reach, const std::function<void(cv::Point2d)>& paint) {
  for (const int dx : {-size, 0, size}) {
    for (const int dy : {-size, 0, size}) {
      const cv::Point2d at(x + dx, y + dy);
      if (at.x > -reach && at.y > -reach && at.x < size + reach && at.y < size + reach) {
        paint(at);
      }
    }
  }
}

cv::Point fixed(const cv::Point2d& point) {  // OpenCV draws between pixels with 4 fractional bits.
  return {static_cast<int>(std::lround(point.x * 16.0)), static_cast<int>(std::lround(point.y * 16.0))};
}

void strokes(cv::Mat& image, int count, double length, double minimum, double maximum, std::uint64_t seed) {
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    const double angle = random.uniform(0.0, 6.2832);
    const double reach = length * random.uniform(0.4, 1.0);
    const cv::Point2d tip(reach * std::cos(angle), reach * std::sin(angle));
    const double grey = random.uniform(minimum, maximum);
    const int width = 1 + random.below(2);
    paintWrapped(image.cols, random.uniform(0.0, image.cols), random.uniform(0.0, image.cols), length,
                 [&](cv::Point2d at) {
                   cv::line(image, fixed(at), fixed(at + tip), cv::Scalar(grey), width, cv::LINE_AA, 4);
                 });
  }
}

void blobs(cv::Mat& image, int count, double smallest, double largest, double minimum, double maximum,
           std::uint64_t seed) {
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    const double radius = smallest * std::pow(largest / smallest, random.uniform());
    const cv::Size2d axes(radius, radius * random.uniform(0.5, 0.95));
    const double angle = random.uniform(0.0, 180.0);
    const double grey = random.uniform(minimum, maximum);
    paintWrapped(image.cols, random.uniform(0.0, image.cols), random.uniform(0.0, image.cols), largest,
                 [&](cv::Point2d at) {
                   const cv::Size size(fixed({axes.width, axes.height}));
                   cv::ellipse(image, fixed(at + cv::Point2d(1.0, 1.0)), size, angle, 0, 360,
                               cv::Scalar(grey * 0.45), cv::FILLED, cv::LINE_AA, 4);
                   cv::ellipse(image, fixed(at), size, angle, 0, 360, cv::Scalar(grey), cv::FILLED,
                               cv::LINE_AA, 4);
                 });
  }
}

/// A leaf: a pointed oval with a vein, from its stalk in a direction.
void leaf(cv::Mat& grey, cv::Mat& opacity, const cv::Point2d& stalk, double angle, double length,
          double shade) {
  const cv::Point2d along(std::cos(angle), std::sin(angle));
  const cv::Point2d across(-along.y, along.x);
  std::vector<cv::Point> outline;
  for (const auto& [u, v] :
       {std::pair{0.0, 0.0}, {0.3, 0.24}, {0.6, 0.22}, {1.0, 0.0}, {0.6, -0.22}, {0.3, -0.24}}) {
    outline.push_back(fixed(stalk + along * (u * length) + across * (v * length)));
  }
  cv::fillConvexPoly(grey, outline, cv::Scalar(shade), cv::LINE_AA, 4);
  cv::fillConvexPoly(opacity, outline, cv::Scalar(255), cv::LINE_AA, 4);
  cv::line(grey, outline[0], outline[3], cv::Scalar(shade * 0.75), 1, cv::LINE_AA, 4);
}

void branch(cv::Mat& grey, cv::Mat& opacity, Random& random, const cv::Point2d& from, double angle,
            double length, int depth) {
  const cv::Point2d to = from + cv::Point2d(std::cos(angle), std::sin(angle)) * length;
  const int width = depth > 1 ? depth : 1;
  cv::line(grey, fixed(from), fixed(to), cv::Scalar(110 + 20 * (3 - depth)), width, cv::LINE_AA, 4);
  cv::line(opacity, fixed(from), fixed(to), cv::Scalar(255), width, cv::LINE_AA, 4);
  for (int i = 0; depth > 0 && i < 3; ++i) {
    const double share = random.uniform(0.3, 1.0);
    branch(grey, opacity, random, from + (to - from) * share, angle + random.uniform(-0.9, 0.9),
           length * random.uniform(0.4, 0.7), depth - 1);
  }
}

struct Layers {
  cv::Mat grey, opacity;
};

Layers leavesTile(int size) {
  Layers layers{cv::Mat(size, size, CV_8U, cv::Scalar(120)), cv::Mat::zeros(size, size, CV_8U)};
  Random random(11);
  for (int i = 0; i < 150; ++i) {
    const double angle = random.uniform(0.0, 6.2832);
    const double distance = 0.40 * size * std::sqrt(random.uniform());
    const cv::Point2d at(size / 2.0 + distance * std::cos(angle), size / 2.0 + distance * std::sin(angle));
    const double shade = 70.0 + 1.15 * i;  // What is painted later lies further out, in more light.
    leaf(layers.grey, layers.opacity, at, angle + random.uniform(-1.2, 1.2),
         size * random.uniform(0.09, 0.15), shade);
  }
  return layers;
}

Layers twigsTile(int size) {
  Layers layers{cv::Mat(size, size, CV_8U, cv::Scalar(130)), cv::Mat::zeros(size, size, CV_8U)};
  Random random(12);
  for (int i = 0; i < 5; ++i) {
    branch(layers.grey, layers.opacity, random, {size * 0.5, size * 0.5},
           i * 1.2566 + random.uniform(-0.4, 0.4), size * 0.24, 3);
  }
  return layers;
}

Layers needlesTile(int size) {
  Layers layers{cv::Mat(size, size, CV_8U, cv::Scalar(110)), cv::Mat::zeros(size, size, CV_8U)};
  Random random(13);
  for (int i = 0; i < 900; ++i) {
    const double u = random.uniform(0.06, 0.94);
    const double droop = (u - 0.06) * size * 0.75;
    const cv::Point2d from(size * 0.5 + (random.uniform() - 0.5) * droop * 0.9, size * u);
    const double angle = 1.5708 + random.uniform(-0.8, 0.8);
    const cv::Point2d to = from + cv::Point2d(std::cos(angle), std::sin(angle)) * (size * 0.06);
    cv::line(layers.grey, fixed(from), fixed(to), cv::Scalar(random.uniform(60.0, 230.0)), 2, cv::LINE_AA, 4);
    cv::line(layers.opacity, fixed(from), fixed(to), cv::Scalar(255), 2, cv::LINE_AA, 4);
  }
  return layers;
}

cv::Mat barkTile(int size) {
  cv::Mat noise = softNoise(size, 16, 4, 14);
  cv::Mat stretched;
  cv::resize(noise, stretched, cv::Size(size, size * 6), 0, 0, cv::INTER_LINEAR);
  cv::Mat tile = stretched(cv::Rect(0, 0, size, size)).clone();
  tile.convertTo(tile, CV_8U, 1.8, -90.0);
  strokes(tile, size / 8, size * 0.05, 20.0, 70.0, 15);
  return tile;
}

/// Rows of rectangles with joints; odd rows are shifted when `shift`.
cv::Mat masonryTile(int size, int rows, int columns, bool shift, double joint_grey, double variation,
                    std::uint64_t seed) {
  cv::Mat tile(size, size, CV_8U, cv::Scalar(joint_grey));
  Random random(seed);
  const int height = size / rows;
  const int width = size / columns;
  for (int row = 0; row < rows; ++row) {
    const int offset = shift && row % 2 == 1 ? width / 2 : 0;
    for (int column = -1; column < columns; ++column) {
      const double grey = 165.0 + variation * random.uniform(-1.0, 1.0);
      const cv::Rect brick(column * width + offset + 2, row * height + 2, width - 3, height - 3);
      cv::rectangle(tile, brick & cv::Rect(0, 0, size, size), cv::Scalar(grey), cv::FILLED);
    }
  }
  cv::Mat noise = softNoise(size, 32, 4, seed + 1);
  cv::addWeighted(tile, 1.0, noise, 0.3, -38.0, tile);
  return tile;
}

void put(cv::Mat& atlas, Tile tile, const cv::Mat& grey, const cv::Mat& opacity) {
  const int index = static_cast<int>(tile);
  const cv::Mat planes[] = {grey, grey, grey, opacity};
  cv::Mat merged;
  cv::merge(planes, 4, merged);
  merged.copyTo(atlas(
      cv::Rect(index % kAtlasColumns * grey.cols, index / kAtlasColumns * grey.rows, grey.cols, grey.rows)));
}

}  // namespace

cv::Mat groundTexture(int size_px) {
  cv::Mat grass = softNoise(size_px, 8, 5, 1);
  grass.convertTo(grass, CV_8U, 0.5, 20.0);
  strokes(grass, size_px * 14, size_px * 0.022, 35.0, 235.0, 2);
  cv::Mat gravel(size_px, size_px, CV_8U, cv::Scalar(95));
  blobs(gravel, size_px * 7, size_px * 0.0025, size_px * 0.012, 90.0, 235.0, 3);
  cv::Mat litter = cv::Mat::zeros(size_px, size_px, CV_8U);
  Random random(4);
  cv::Mat ignored = cv::Mat::zeros(size_px, size_px, CV_8U);
  for (int i = 0; i < 900; ++i) {
    const double angle = random.uniform(0.0, 6.2832);
    const double length = size_px * random.uniform(0.022, 0.04);
    const double shade = random.uniform(70.0, 255.0);
    paintWrapped(size_px, random.uniform(0.0, size_px), random.uniform(0.0, size_px), length,
                 [&](cv::Point2d at) { leaf(litter, ignored, at, angle, length, shade); });
  }
  cv::Mat noise = softNoise(size_px, 4, 7, 5);
  cv::Mat texture;
  const cv::Mat planes[] = {grass, gravel, litter, noise};
  cv::merge(planes, 4, texture);
  return texture;
}

cv::Mat objectAtlas(int tile_px) {
  cv::Mat atlas(tile_px * kAtlasRows, tile_px * kAtlasColumns, CV_8UC4);
  const cv::Mat opaque(tile_px, tile_px, CV_8U, cv::Scalar(255));
  const Layers leaves = leavesTile(tile_px);
  const Layers twigs = twigsTile(tile_px);
  const Layers needles = needlesTile(tile_px);
  put(atlas, Tile::kLeaves, leaves.grey, leaves.opacity);
  put(atlas, Tile::kTwigs, twigs.grey, twigs.opacity);
  put(atlas, Tile::kNeedles, needles.grey, needles.opacity);
  put(atlas, Tile::kBark, barkTile(tile_px), opaque);
  put(atlas, Tile::kBricks, masonryTile(tile_px, 16, 6, true, 190.0, 45.0, 21), opaque);
  put(atlas, Tile::kPlanks, masonryTile(tile_px, 6, 1, false, 60.0, 35.0, 22), opaque);
  put(atlas, Tile::kRoof, masonryTile(tile_px, 10, 8, true, 70.0, 40.0, 23), opaque);
  put(atlas, Tile::kPlain, softNoise(tile_px, 8, 5, 24) * 0.35 + 110, opaque);
  return atlas;
}

}  // namespace perennial::park
