#pragma once

#include <utility>
#include <vector>

#include "core/features/duplicate_filter.h"
#include "core/features/hessian_pyramid.h"
#include "core/features/integral_image.h"
#include "core/features/maxima.h"
#include "core/features/patch_margin.h"
#include "perennial/core/feature_extractor.h"

namespace perennial {

/// Upright SURF detector, the "fast Hessian" of Bay et al., CVIU 2008, section 3.
///
/// The result is, by definition: of all maxima of the scale space with a response of at least `min_response`,
/// refined, whose patch fits the image, without those that a stronger one of another octave makes duplicates,
/// the strongest `features`; by falling response, then y, x and scale. Nothing of an earlier image enters it.
/// With buckets, instead of the strongest `features`: those of the best rank within their bucket, of equal
/// rank the strongest.
///
/// What adapts from image to image is where the search starts: at the response that would have given the
/// image before a quarter more candidates than it needed. When that finds too few, the image is searched
/// again with lower thresholds, down to `min_response`. A candidate's fate depends on stronger candidates
/// only, so every threshold that finds enough gives the same result. One instance serves one thread. With
/// buckets every candidate counts, so that the search starts at `min_response`.
class SurfDetector {
 public:
  explicit SurfDetector(const ExtractionSettings& settings);

  /// The reference is valid until the next call.
  const std::vector<Keypoint>& detect(const IntegralImage& integral, const PatchMargin& margin);

  /// Where the search of the next image starts.
  float threshold() const { return threshold_; }

 private:
  void findCandidates(float threshold, const IntegralImage& integral, const PatchMargin& margin);
  void selectStrongest(const IntegralImage& integral);
  void selectFromBuckets(const IntegralImage& integral);
  bool bucketed() const { return settings_.bucket_columns * settings_.bucket_rows > 1; }
  void adaptThreshold();

  ExtractionSettings settings_;
  float min_response_;
  float threshold_;
  HessianPyramid pyramid_;
  DuplicateFilter duplicates_;
  std::vector<Maximum> maxima_;
  std::vector<Candidate> candidates_;  ///< strongest first
  std::size_t examined_ = 0;           ///< candidates that it took to select the keypoints
  std::vector<Keypoint> keypoints_;
  std::vector<int> bucket_sizes_;            ///< candidates of each bucket so far
  std::vector<std::pair<int, int>> ranked_;  ///< rank within the bucket, number of the candidate
};

}  // namespace perennial
