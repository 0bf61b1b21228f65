#pragma once

#include <opencv2/core.hpp>

#include "core/features/box_sums.h"
#include "core/features/brief_descriptor.h"
#include "core/features/brief_pattern.h"
#include "core/features/integral_image.h"
#include "core/features/orientation_image.h"
#include "core/features/patch_margin.h"
#include "perennial/core/feature.h"

namespace perennial {

/// Describes keypoints by 256 bits that stay the same when contrasts turn over, as between leaves and snow or
/// day and searchlight: BRIEF's tests, of the same pattern, on orientations instead of intensities.
///
/// Of every eight tests the first two are of intensities, but in pairs: bit i says whether tests i and i +
/// 128 (mod 256) of BRIEF differ, which turning the contrast over does not change. The others are of cosine
/// (even i) and sine (odd i) of the doubled gradient angle, smoothed by the same box: set when the first
/// place has less of it than the second. Orientations alone confuse buildings' windows; an eighth to a half
/// of intensities do not (see docs/registration.md). One instance serves one thread.
class OrientationDescriptor {
 public:
  static constexpr PatchMargin kMargin = BriefDescriptor::kMargin;

  /// Takes the image that is described from now on, and its integral image. Memory is kept and used again.
  void prepare(const cv::Mat& image, const IntegralImage& integral);

  /// `centre` must fit the image by kMargin.
  Descriptor describe(const Pixel& centre) const noexcept;

 private:
  OrientationImages orientation_;
  IntegralImage integral_;
  BoxSums intensity_;
  BoxSums cosine_;
  BoxSums sine_;
  BriefOffsets offsets_;
};

}  // namespace perennial
