#include "core/features/maxima.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/simd/kernels.h"

namespace perennial {
namespace {

/// Three layers that are neighbours in scale, and the middle one's place in the pyramid.
struct Triple {
  const ResponseLayer& below;
  const ResponseLayer& centre;
  const ResponseLayer& above;
};

/// Row `j` of a layer with its neighbours.
struct Rows {
  Rows(const ResponseLayer& layer, int j)
      : up(layer.row(j - 1)), here(layer.row(j)), down(layer.row(j + 1)) {}

  const float* up;
  const float* here;
  const float* down;
};

float greatestOfThree(const float* row, int i) { return std::max({row[i - 1], row[i], row[i + 1]}); }

float greatestOfNine(const Rows& rows, int i) {
  return std::max(
      {greatestOfThree(rows.up, i), greatestOfThree(rows.here, i), greatestOfThree(rows.down, i)});
}

/// Not less than the neighbours that come before it, greater than those that come after it.
bool isMaximum(const Rows& below, const Rows& centre, const Rows& above, int i) {
  const float value = centre.here[i];
  return value >= centre.here[i - 1] && value > centre.here[i + 1] &&
         value >= greatestOfThree(centre.up, i) && value > greatestOfThree(centre.down, i) &&
         value >= greatestOfNine(below, i) && value > greatestOfNine(above, i);
}

void findInRow(const Triple& layers, float threshold, Maximum where, std::vector<Maximum>& maxima) {
  const Rows below(layers.below, where.j);
  const Rows centre(layers.centre, where.j);
  const Rows above(layers.above, where.j);
  const int end = layers.above.columns_end - 1;
  const auto next = kernels().next_peak;
  for (int i = next(centre.up, centre.here, centre.down, layers.above.begin + 1, end, threshold); i < end;
       i = next(centre.up, centre.here, centre.down, i + 1, end, threshold)) {
    if (isMaximum(below, centre, above, i)) {
      where.i = i;
      where.response = centre.here[i];
      maxima.push_back(where);
    }
  }
}

/// Value, gradient and second derivatives by central differences, in samples; axes x, y, scale.
struct Quadratic {
  Quadratic(const HessianPyramid& pyramid, const IntegralImage& integral, const Maximum& at) {
    const auto value = [&](int dx, int dy, int ds) {
      const ResponseLayer& layer = pyramid.layer(at.octave, at.layer + ds);
      return static_cast<double>(pyramid.responseAt(integral, layer, at.i + dx, at.j + dy));
    };
    const double centre = value(0, 0, 0);
    gx = 0.5 * (value(1, 0, 0) - value(-1, 0, 0));
    gy = 0.5 * (value(0, 1, 0) - value(0, -1, 0));
    gs = 0.5 * (value(0, 0, 1) - value(0, 0, -1));
    xx = value(1, 0, 0) + value(-1, 0, 0) - 2.0 * centre;
    yy = value(0, 1, 0) + value(0, -1, 0) - 2.0 * centre;
    ss = value(0, 0, 1) + value(0, 0, -1) - 2.0 * centre;
    xy = 0.25 * (value(1, 1, 0) + value(-1, -1, 0) - value(1, -1, 0) - value(-1, 1, 0));
    xs = 0.25 * (value(1, 0, 1) + value(-1, 0, -1) - value(1, 0, -1) - value(-1, 0, 1));
    ys = 0.25 * (value(0, 1, 1) + value(0, -1, -1) - value(0, 1, -1) - value(0, -1, 1));
  }

  /// Solves H offset = -gradient by Cramer's rule; not finite when H is singular.
  std::array<double, 3> extremum() const {
    const double cx = yy * ss - ys * ys;  // cofactors of the first row
    const double cy = ys * xs - xy * ss;
    const double cs = xy * ys - yy * xs;
    const double determinant = xx * cx + xy * cy + xs * cs;
    const double dx = cx * gx + cy * gy + cs * gs;
    const double dy = cy * gx + (xx * ss - xs * xs) * gy + (xy * xs - xx * ys) * gs;
    const double ds = cs * gx + (xy * xs - xx * ys) * gy + (xx * yy - xy * xy) * gs;
    return {-dx / determinant, -dy / determinant, -ds / determinant};
  }

  double gx, gy, gs;
  double xx, yy, ss, xy, xs, ys;
};

}  // namespace

int nextPeak(const float* up, const float* here, const float* down, int begin, int end,
             float threshold) noexcept {
  for (int i = begin; i < end; ++i) {
    const float value = here[i];
    if (value >= threshold && value >= here[i - 1] && value >= up[i] && value > here[i + 1] &&
        value > down[i]) {
      return i;
    }
  }
  return std::max(begin, end);
}

void findMaxima(const HessianPyramid& pyramid, float threshold, std::vector<Maximum>& maxima) {
  for (int octave = 0; octave < pyramid.octaves(); ++octave) {
    for (int j = 1; j + 1 < pyramid.layer(octave, 0).rows; ++j) {
      findMaximaInRow(pyramid, octave, j, threshold, maxima);
    }
  }
}

void findMaximaInRow(const HessianPyramid& pyramid, int octave, int j, float threshold,
                     std::vector<Maximum>& maxima) {
  for (int index = 1; index + 1 < pyramid.layersPerOctave(); ++index) {
    const Triple layers{pyramid.layer(octave, index - 1), pyramid.layer(octave, index),
                        pyramid.layer(octave, index + 1)};
    if (j > layers.above.begin && j < layers.above.rows_end - 1) {
      findInRow(layers, threshold, {octave, index, 0, j, 0.0F}, maxima);
    }
  }
}

std::optional<Keypoint> refine(const HessianPyramid& pyramid, const IntegralImage& integral,
                               const Maximum& maximum) {
  const auto [dx, dy, ds] = Quadratic(pyramid, integral, maximum).extremum();
  if (!(std::abs(dx) < 1.0 && std::abs(dy) < 1.0 && std::abs(ds) < 1.0)) {
    return std::nullopt;
  }
  const ResponseLayer& layer = pyramid.layer(maximum.octave, maximum.layer);
  const ResponseLayer& above = pyramid.layer(maximum.octave, maximum.layer + 1);
  const double size_step = above.filter.size() - layer.filter.size();
  Keypoint keypoint;
  keypoint.x = static_cast<float>((maximum.i + dx) * layer.step);
  keypoint.y = static_cast<float>((maximum.j + dy) * layer.step);
  keypoint.scale = scaleOfFilterSize(static_cast<float>(layer.filter.size() + ds * size_step));
  keypoint.response = maximum.response;
  return keypoint;
}

}  // namespace perennial
