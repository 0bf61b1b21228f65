#include "core/features/surf_detector.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace perennial {
namespace {

/// How much lower an image is searched again.
constexpr float kLowering = 0.1F;
/// How much the threshold falls for the next image when this one had no candidates to spare.
constexpr float kCaution = 0.7F;

/// Total order of candidates: by falling response, then y, x, scale; equal ones by octave.
bool isBefore(const Candidate& a, const Candidate& b) {
  const Keypoint& p = a.keypoint;
  const Keypoint& q = b.keypoint;
  return std::tie(q.response, p.y, p.x, p.scale, a.octave) <
         std::tie(p.response, q.y, q.x, q.scale, b.octave);
}

}  // namespace

SurfDetector::SurfDetector(const ExtractionSettings& settings)
    : settings_(settings),
      // A response of 0 is no blob, but what a constant image has everywhere.
      min_response_(std::max(static_cast<float>(settings.min_response), std::numeric_limits<float>::min())),
      threshold_(min_response_),
      pyramid_(settings.octaves, settings.layers) {}

const std::vector<Keypoint>& SurfDetector::detect(const IntegralImage& integral, const PatchMargin& margin) {
  pyramid_.compute(integral);
  const auto wanted = static_cast<std::size_t>(settings_.features);
  while (true) {
    findCandidates(threshold_, integral, margin);
    selectStrongest(integral);
    if (keypoints_.size() >= wanted || threshold_ <= min_response_) {
      break;
    }
    threshold_ = std::max(min_response_, kLowering * threshold_);
  }
  adaptThreshold();
  return keypoints_;
}

void SurfDetector::findCandidates(float threshold, const IntegralImage& integral, const PatchMargin& margin) {
  maxima_.clear();
  candidates_.clear();
  findMaxima(pyramid_, threshold, maxima_);
  for (const Maximum& maximum : maxima_) {
    const std::optional<Keypoint> keypoint = refine(pyramid_, maximum);
    if (keypoint && margin.fits(nearestPixel(*keypoint), integral.columns(), integral.rows())) {
      candidates_.push_back({*keypoint, maximum.octave});
    }
  }
  std::sort(candidates_.begin(), candidates_.end(), isBefore);
}

void SurfDetector::selectStrongest(const IntegralImage& integral) {
  const auto wanted = static_cast<std::size_t>(settings_.features);
  keypoints_.clear();
  duplicates_.reset(integral.columns(), integral.rows(), settings_.octaves);
  for (examined_ = 0; examined_ < candidates_.size() && keypoints_.size() < wanted; ++examined_) {
    if (duplicates_.accept(candidates_[examined_])) {
      keypoints_.push_back(candidates_[examined_].keypoint);
    }
  }
}

void SurfDetector::adaptThreshold() {
  const std::size_t aim = examined_ + examined_ / 4;
  if (aim < candidates_.size()) {
    threshold_ = candidates_[aim].keypoint.response;
  } else {
    threshold_ = std::max(min_response_, kCaution * threshold_);
  }
}

}  // namespace perennial
