#pragma once

#include "core/features/box_sums.h"
#include "core/features/brief_pattern.h"
#include "core/features/integral_image.h"
#include "core/features/patch_margin.h"
#include "perennial/core/feature.h"

namespace perennial {

/// Describes keypoints by 256-bit BRIEF (Calonder et al., ECCV 2010): bit i is set when the smoothed image is
/// darker at the first place of test i than at the second.
///
/// Patch and pattern are upright and of fixed size, whatever the keypoint's scale, as in the paper: the robot
/// sees a place again from about the same distance. Places are relative to the pixel nearest to the keypoint.
/// Smoothing is by a 9x9 box, the usual replacement of the paper's 9x9 Gaussian kernel. One instance serves
/// one thread.
class BriefDescriptor {
 public:
  static constexpr int kSmoothing = BoxSums::kSide;
  static constexpr PatchMargin kMargin{
      kBriefPatch / 2 + kSmoothing / 2,  ///< the patch and the smoothing around it
      kBriefPatch / 2 - 1 + kSmoothing / 2};

  /// Takes the image that is described from now on. Memory is kept and used again.
  void prepare(const IntegralImage& integral);

  /// `centre` must fit the image by kMargin.
  Descriptor describe(const Pixel& centre) const noexcept;

 private:
  BoxSums smoothed_;
  BriefOffsets offsets_;
};

}  // namespace perennial
