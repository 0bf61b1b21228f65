#include "core/features/hessian_pyramid.h"

#include <algorithm>
#include <limits>

#include "core/simd/kernels.h"

namespace perennial {
namespace {

/// Where more than half of a row has to be computed anyway, computing so many rows whole is cheaper than
/// looking first.
constexpr int kDenseRows = 15;

/// Samples 0, step, 2 step, ... that lie before `length`.
int samples(int length, int step) { return length > 0 ? (length + step - 1) / step : 0; }

/// Gives the layer the size that belongs to an image.
void fitLayer(int image_columns, int image_rows, int rows_held, ResponseLayer& layer) {
  const int half = layer.filter.half();
  layer.columns = samples(image_columns, layer.step);
  layer.rows = samples(image_rows, layer.step);
  layer.begin = samples(half, layer.step);
  layer.columns_end = samples(image_columns - half, layer.step);
  layer.rows_end = samples(image_rows - half, layer.step);
  layer.row_mask = rows_held < layer.rows ? rows_held - 1 : std::numeric_limits<int>::max();
  const auto held = static_cast<std::size_t>(std::min(rows_held, layer.rows));
  const auto size = static_cast<std::size_t>(layer.columns) * held;
  layer.responses.assign(size + kReadBeyond, 0.0F);
}

/// Takes every other sample of row 2 j of the same filter's responses in the octave below.
void subsampleRow(const ResponseLayer& finer, int j, ResponseLayer& coarser) {
  if (j < coarser.begin || j >= coarser.rows_end) {
    return;
  }
  kernels().every_other(finer.row(2 * j) + 2 * coarser.begin, coarser.columns_end - coarser.begin,
                        coarser.row(j) + coarser.begin);
}

}  // namespace

HessianPyramid::HessianPyramid(int octaves, int layers) : octaves_(octaves), layers_(layers) {
  for (int octave = 0; octave < octaves; ++octave) {
    const int step = 1 << octave;
    for (int index = 0; index < layersPerOctave(); ++index) {
      ResponseLayer layer;
      layer.filter.lobe = 2 * step * (index + 1) + 1;
      layer.step = step;
      pyramid_.push_back(layer);
    }
  }
}

void HessianPyramid::compute(const IntegralImage& integral) {
  fit(integral, integral.rows());
  threshold_ = kBelowThreshold;
  for (int octave = 0; octave < octaves_; ++octave) {
    computeOctave(integral, octave, false);
  }
}

void HessianPyramid::computeRow(const IntegralImage& integral, int j) {
  for (int index = 0; index < layersPerOctave(); ++index) {
    filterRow(integral, pyramid_[position(0, index)], j);
  }
  if (octaves_ == 1 || j % 2 == 1) {
    return;
  }
  for (int index = 0; sameBelow(1, index) >= 0; ++index) {
    subsampleRow(layer(0, sameBelow(1, index)), j / 2, pyramid_[position(1, index)]);
  }
}

void HessianPyramid::computeOctave(const IntegralImage& integral, int octave, bool copied) {
  for (int index = 0; index < layersPerOctave(); ++index) {
    ResponseLayer& here = pyramid_[position(octave, index)];
    const int same = sameBelow(octave, index);
    if (same >= 0 && copied) {
      continue;
    }
    for (int j = here.begin; j < here.rows_end; ++j) {
      if (same >= 0) {
        subsampleRow(layer(octave - 1, same), j, here);
      } else {
        filterRow(integral, here, j);
      }
    }
  }
}

void HessianPyramid::fit(const IntegralImage& integral, int rows_held) {
  if (integral.columns() == columns_ && integral.rows() == rows_ && rows_held == rows_held_) {
    return;
  }
  columns_ = integral.columns();
  rows_ = integral.rows();
  rows_held_ = rows_held;
  for (ResponseLayer& layer : pyramid_) {
    fitLayer(columns_, rows_, layer.step == 1 ? rows_held : rows_, layer);
  }
  differences_.resize(static_cast<std::size_t>(columns_) + 1);
  full_row_.resize(static_cast<std::size_t>(columns_) + 1);
}

void HessianPyramid::filterRow(const IntegralImage& integral, ResponseLayer& layer, int j) {
  const int count = layer.columns_end - layer.begin;
  if (count <= 0 || j < layer.begin || j >= layer.rows_end) {
    return;
  }
  const int first_x = layer.begin * layer.step;
  const int last_x = (layer.columns_end - 1) * layer.step;
  float* const responses = layer.row(j) + layer.begin;
  if (layer.step == 1) {
    filterPixels(integral, layer, j, first_x, count, responses);
    return;
  }
  // Every pixel, then every other one of them, and so on: vector code does a whole row faster than scalar
  // code its samples.
  int left = last_x - first_x + 1;
  filterPixels(integral, layer, j * layer.step, first_x, left, full_row_.data());
  const auto every_other = kernels().every_other;
  for (int step = layer.step; step > 2; step /= 2) {
    left = samples(left, 2);
    every_other(full_row_.data(), left, full_row_.data());
  }
  every_other(full_row_.data(), count, responses);
}

void HessianPyramid::filterPixels(const IntegralImage& integral, ResponseLayer& layer, int y, int first_x,
                                  int count, float* responses) {
  const Kernels& use = kernels();
  const FilterRows rows(integral, layer.filter, y);
  if (threshold_ == kBelowThreshold || layer.dense_rows > 0 || !use.looks_first) {
    layer.dense_rows = std::max(0, layer.dense_rows - 1);
    use.difference_columns(rows, first_x - layer.filter.half(), first_x + count + layer.filter.half() + 1,
                           differences_);
    use.hessian_row(differences_, layer.filter, first_x, count, responses);
    return;
  }
  const int computed =
      use.filter_row_above(rows, layer.filter, first_x, count, threshold_, differences_, responses);
  if (2 * computed > count) {
    layer.dense_rows = kDenseRows;
  }
}

}  // namespace perennial
