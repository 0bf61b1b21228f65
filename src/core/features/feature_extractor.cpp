#include "perennial/core/feature_extractor.h"

#include "core/features/brief_descriptor.h"
#include "core/features/half_image.h"
#include "core/features/integral_image.h"
#include "core/features/surf_detector.h"
#include "perennial/core/error.h"

namespace perennial {
namespace {

/// Settings that were not loaded are held against the same ranges.
ExtractionSettings checked(const ExtractionSettings& settings) {
  ParameterReader reader({{"features", settings.features},
                          {"octaves", settings.octaves},
                          {"layers", settings.layers},
                          {"min_response", settings.min_response},
                          {"half_resolution", settings.half_resolution},
                          {"bucket_columns", settings.bucket_columns},
                          {"bucket_rows", settings.bucket_rows}});
  return ExtractionSettings::load(reader);
}

}  // namespace

struct FeatureExtractor::Implementation {
  explicit Implementation(const ExtractionSettings& chosen) : settings(checked(chosen)), detector(settings) {}

  ExtractionSettings settings;
  cv::Mat half;
  IntegralImage integral;
  SurfDetector detector;
  BriefDescriptor descriptor;
};

FeatureExtractor::FeatureExtractor(const ExtractionSettings& settings)
    : implementation_(std::make_unique<Implementation>(settings)) {}
FeatureExtractor::~FeatureExtractor() = default;
FeatureExtractor::FeatureExtractor(FeatureExtractor&&) noexcept = default;
FeatureExtractor& FeatureExtractor::operator=(FeatureExtractor&&) noexcept = default;

FeatureSet FeatureExtractor::extract(const cv::Mat& image) {
  FeatureSet features;
  extractInto(image, features);
  return features;
}

void FeatureExtractor::extractInto(const cv::Mat& image, FeatureSet& features) {
  if (!image.empty() && (image.type() != CV_8UC1 || image.dims != 2)) {
    throw ImageError("features are extracted from 8-bit grey images (CV_8UC1), not from " +
                     std::to_string(image.channels()) + " channels of OpenCV depth " +
                     std::to_string(image.depth()) + "; convert the image first");
  }
  Implementation& parts = *implementation_;
  const bool halve = parts.settings.half_resolution;
  if (halve) {
    halveImage(image, parts.half);
  }
  parts.integral.compute(halve ? parts.half : image);
  const std::vector<Keypoint>& keypoints = parts.detector.detect(parts.integral, BriefDescriptor::kMargin);
  parts.descriptor.prepare(parts.integral);
  features.clear();
  features.reserve(keypoints.size());
  for (const Keypoint& keypoint : keypoints) {
    features.add(halve ? inFullImage(keypoint) : keypoint, parts.descriptor.describe(nearestPixel(keypoint)));
  }
}

const ExtractionSettings& FeatureExtractor::settings() const { return implementation_->settings; }

}  // namespace perennial
