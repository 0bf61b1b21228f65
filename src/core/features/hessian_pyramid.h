#pragma once

#include <cstddef>
#include <vector>

#include "core/features/box_hessian.h"
#include "core/features/integral_image.h"

namespace perennial {

/// Responses of one filter, sampled every `step` px: sample (i, j) belongs to pixel (i step, j step).
struct ResponseLayer {
  BoxFilter filter;
  int step = 1;     ///< px between samples
  int columns = 0;  ///< samples
  int rows = 0;     ///< samples
  /// Samples begin..columns_end-1, begin..rows_end-1 have responses: the filter lies within the image. The
  /// others are 0.
  int begin = 0;
  int columns_end = 0;
  int rows_end = 0;
  std::vector<float> responses;

  const float* row(int j) const {
    return responses.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(columns);
  }
  float* row(int j) {
    return responses.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(columns);
  }
};

/// Scale space of Hessian determinants (Bay et al., CVIU 2008, section 3.3).
///
/// Maxima are sought in `layers` layers per octave, which takes one more below and one more above: octave o
/// consists of layers + 2 filters with lobes 2^(o+1) (l + 1) + 1, l = 0..layers+1, sampled every 2^o px. With
/// 4 octaves and 3 layers these are the sizes 9 15 21 27 33, 15 27 39 51 63, 27 51 75 99 123, 51 99 147 195
/// 243: 20 filter layers. Every size that the octave below has too is copied from there, every other sample,
/// so that 14 layers are really computed.
class HessianPyramid {
 public:
  HessianPyramid(int octaves, int layers);

  /// Memory is kept and used again for images of the same size.
  void compute(const IntegralImage& integral);

  int octaves() const { return octaves_; }
  int layersPerOctave() const { return layers_ + 2; }  ///< with the lowest and the highest
  const ResponseLayer& layer(int octave, int index) const { return pyramid_[position(octave, index)]; }

 private:
  std::size_t position(int octave, int index) const {
    return static_cast<std::size_t>(octave * layersPerOctave() + index);
  }
  void fit(const IntegralImage& integral);
  void filter(const IntegralImage& integral, ResponseLayer& layer);

  int octaves_;
  int layers_;
  int columns_ = 0;  ///< of the image that the layers fit
  int rows_ = 0;
  std::vector<ResponseLayer> pyramid_;
  ColumnDifferences differences_;
};

}  // namespace perennial
