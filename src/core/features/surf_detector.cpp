#include "core/features/surf_detector.h"

#include <algorithm>
#include <limits>
#include <optional>
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
  if (bucketed()) {
    findCandidates(min_response_, integral, margin);
    selectFromBuckets(integral);
    return keypoints_;
  }
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
  candidates_.clear();
  pyramid_.stream(integral, threshold, [&](int octave, int j) {
    maxima_.clear();
    findMaximaInRow(pyramid_, octave, j, threshold, maxima_);
    for (const Maximum& maximum : maxima_) {
      const std::optional<Keypoint> keypoint = refine(pyramid_, integral, maximum);
      if (keypoint && margin.fits(nearestPixel(*keypoint), integral.columns(), integral.rows())) {
        candidates_.push_back({*keypoint, maximum.octave});
      }
    }
  });
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

void SurfDetector::selectFromBuckets(const IntegralImage& integral) {
  keypoints_.clear();
  ranked_.clear();
  bucket_sizes_.assign(static_cast<std::size_t>(settings_.bucket_columns * settings_.bucket_rows), 0);
  duplicates_.reset(integral.columns(), integral.rows(), settings_.octaves);
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (duplicates_.accept(candidates_[i])) {
      const Pixel centre = nearestPixel(candidates_[i].keypoint);
      const int column = centre.x * settings_.bucket_columns / integral.columns();
      const int row = centre.y * settings_.bucket_rows / integral.rows();
      int& size = bucket_sizes_[static_cast<std::size_t>(row * settings_.bucket_columns + column)];
      ranked_.emplace_back(size++, static_cast<int>(i));
    }
  }
  std::sort(ranked_.begin(), ranked_.end());
  ranked_.resize(std::min(ranked_.size(), static_cast<std::size_t>(settings_.features)));
  // Back to the order of strength.
  std::sort(ranked_.begin(), ranked_.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  for (const auto& ranked : ranked_) {
    keypoints_.push_back(candidates_[static_cast<std::size_t>(ranked.second)].keypoint);
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
