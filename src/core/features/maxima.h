#pragma once

#include <optional>
#include <vector>

#include "core/features/hessian_pyramid.h"
#include "perennial/core/feature.h"

namespace perennial {

/// A sample of the pyramid that is greater than its 26 neighbours in position and scale.
struct Maximum {
  int octave = 0;
  int layer = 0;  ///< within the octave, 1..layers
  int i = 0;      ///< sample, along the row
  int j = 0;      ///< sample, row
  float response = 0.0F;
};

/// The first of the samples begin..end-1 of a row that reaches the threshold, is not less than its left and
/// upper neighbours and greater than its right and lower ones: few do, so that most of a row is passed over.
/// `end` when there is none. Up to kReadBeyond samples behind `end` may be read.
int nextPeak(const float* up, const float* here, const float* down, int begin, int end,
             float threshold) noexcept;

/// Appends every maximum with response >= `threshold` (which must be positive), octave by octave.
///
/// Of two neighbours that are exactly equal the one that comes later (in scale, then y, then x) is the
/// maximum, so that a blob centred between samples is found, once. Only samples count whose filters in all
/// three layers lie within the image.
void findMaxima(const HessianPyramid& pyramid, float threshold, std::vector<Maximum>& maxima);

/// The same for row `j` of one octave, in all layers.
void findMaximaInRow(const HessianPyramid& pyramid, int octave, int j, float threshold,
                     std::vector<Maximum>& maxima);

/// Position and scale of the extremum of the quadratic through the 27 responses around a maximum (Brown and
/// Lowe, BMVC 2002). None when it lies a whole sample or more away in any direction, or when there is none:
/// then the responses are no blob. The keypoint keeps the sample's response.
std::optional<Keypoint> refine(const HessianPyramid& pyramid, const IntegralImage& integral,
                               const Maximum& maximum);

}  // namespace perennial
