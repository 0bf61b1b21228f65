#include "core/features/hessian_pyramid.h"

#include <algorithm>

namespace perennial {
namespace {

/// Samples 0, step, 2 step, ... that lie before `length`.
int samples(int length, int step) { return length > 0 ? (length + step - 1) / step : 0; }

/// Gives the layer the size that belongs to an image.
void fitLayer(int image_columns, int image_rows, ResponseLayer& layer) {
  const int half = layer.filter.half();
  layer.columns = samples(image_columns, layer.step);
  layer.rows = samples(image_rows, layer.step);
  layer.begin = samples(half, layer.step);
  layer.columns_end = samples(image_columns - half, layer.step);
  layer.rows_end = samples(image_rows - half, layer.step);
  const auto size = static_cast<std::size_t>(layer.columns) * static_cast<std::size_t>(layer.rows);
  layer.responses.assign(size, 0.0F);
}

/// Takes every other sample of the same filter's responses in the octave below.
void subsample(const ResponseLayer& finer, ResponseLayer& coarser) {
  for (int j = coarser.begin; j < coarser.rows_end; ++j) {
    const float* const from = finer.row(2 * j);
    float* const to = coarser.row(j);
    for (int i = coarser.begin; i < coarser.columns_end; ++i) {
      to[i] = from[2 * i];
    }
  }
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
  fit(integral);
  for (int octave = 0; octave < octaves_; ++octave) {
    for (int index = 0; index < layersPerOctave(); ++index) {
      const int same_filter = 2 * index + 1;
      if (octave > 0 && same_filter < layersPerOctave()) {
        subsample(layer(octave - 1, same_filter), pyramid_[position(octave, index)]);
      } else {
        filter(integral, pyramid_[position(octave, index)]);
      }
    }
  }
}

void HessianPyramid::fit(const IntegralImage& integral) {
  if (integral.columns() == columns_ && integral.rows() == rows_) {
    return;
  }
  columns_ = integral.columns();
  rows_ = integral.rows();
  for (ResponseLayer& layer : pyramid_) {
    fitLayer(columns_, rows_, layer);
  }
  differences_.resize(static_cast<std::size_t>(columns_) + 1);
}

void HessianPyramid::filter(const IntegralImage& integral, ResponseLayer& layer) {
  const int count = layer.columns_end - layer.begin;
  if (count <= 0) {
    return;
  }
  const int first_x = layer.begin * layer.step;
  const int last_x = (layer.columns_end - 1) * layer.step;
  const int half = layer.filter.half();
  for (int j = layer.begin; j < layer.rows_end; ++j) {
    const FilterRows rows(integral, layer.filter, j * layer.step);
    differenceColumns(rows, first_x - half, last_x + half + 2, differences_);
    hessianRow(differences_, layer.filter, first_x, layer.step, count, layer.row(j) + layer.begin);
  }
}

}  // namespace perennial
