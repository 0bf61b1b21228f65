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
  int dense_rows =
      0;  ///< rows to come in which every response is computed, because most were in the row before
  /// Row j is in memory at place j & row_mask: all rows, or the newest few where maxima are sought on the
  /// way.
  int row_mask = 0;
  std::vector<float> responses;

  /// Row j, which must be among those held.
  const float* row(int j) const { return responses.data() + place(j); }
  float* row(int j) { return responses.data() + place(j); }

 private:
  std::size_t place(int j) const {
    return static_cast<std::size_t>(j & row_mask) * static_cast<std::size_t>(columns);
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

  /// The same, handing out rows as they come: visit(octave, j) is called when rows j - 1 .. j + 1 of all
  /// layers of the octave are there, octave by octave, for all j but an octave's first and last. Of octave 0
  /// only a few rows are held: its responses never leave the processor's cache, which takes half the time of
  /// writing and reading them. Responses that are known to stay below `threshold` may be kBelowThreshold
  /// instead; see responseAt().
  template <class Visit>
  void stream(const IntegralImage& integral, float threshold, Visit visit) {
    fit(integral, kRowsStreamed);
    threshold_ = threshold;
    for (int j = 0; j < rows_; ++j) {
      computeRow(integral, j);
      if (j > 1) {
        visit(0, j - 1);
      }
    }
    for (int octave = 1; octave < octaves_; ++octave) {
      computeOctave(integral, octave, octave == 1);
      for (int j = 1; j + 1 < layer(octave, 0).rows; ++j) {
        visit(octave, j);
      }
    }
  }

  /// The response at a sample of a row that is held, also where it was left out.
  float responseAt(const IntegralImage& integral, const ResponseLayer& layer, int i, int j) const {
    const float response = layer.row(j)[i];
    return response == kBelowThreshold ? hessianAt(integral, layer.filter, i * layer.step, j * layer.step)
                                       : response;
  }

  int octaves() const { return octaves_; }
  int layersPerOctave() const { return layers_ + 2; }  ///< with the lowest and the highest
  const ResponseLayer& layer(int octave, int index) const { return pyramid_[position(octave, index)]; }

 private:
  static constexpr int kRowsStreamed = 4;  ///< a power of two

  std::size_t position(int octave, int index) const {
    return static_cast<std::size_t>(octave * layersPerOctave() + index);
  }
  /// Which layer of the octave below has the same filter, or -1.
  int sameBelow(int octave, int index) const {
    const int same = 2 * index + 1;
    return octave > 0 && same < layersPerOctave() ? same : -1;
  }
  /// `rows_held`: of octave 0's layers.
  void fit(const IntegralImage& integral, int rows_held);
  /// One row of octave 0, in all layers, and what octave 1 takes from it.
  void computeRow(const IntegralImage& integral, int j);
  /// `copied`: the layers that the octave below has too are filled already.
  void computeOctave(const IntegralImage& integral, int octave, bool copied);
  void filterRow(const IntegralImage& integral, ResponseLayer& layer, int j);
  /// Responses of pixels first_x .. first_x + count - 1 of an image row.
  void filterPixels(const IntegralImage& integral, ResponseLayer& layer, int y, int first_x, int count,
                    float* responses);

  int octaves_;
  int layers_;
  int columns_ = -1;  ///< of the image that the layers fit; none yet
  int rows_ = 0;
  int rows_held_ = 0;
  float threshold_ = kBelowThreshold;  ///< responses below it need not be computed
  std::vector<ResponseLayer> pyramid_;
  ColumnDifferences differences_;
  std::vector<float> full_row_;  ///< responses at every pixel of a row, where only some are kept
};

}  // namespace perennial
