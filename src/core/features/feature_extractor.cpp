#include "perennial/core/feature_extractor.h"

#include "core/features/brief_descriptor.h"
#include "core/features/edge_field_extractor.h"
#include "core/features/half_image.h"
#include "core/features/integral_image.h"
#include "core/features/orientation_descriptor.h"
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
                          {"bucket_rows", settings.bucket_rows},
                          {"descriptor", nameOf(settings.descriptor)}});
  return ExtractionSettings::load(reader);
}

}  // namespace

struct FeatureExtractor::Implementation {
  explicit Implementation(const ExtractionSettings& chosen) : settings(checked(chosen)), detector(settings) {}

  ExtractionSettings settings;
  cv::Mat half;
  IntegralImage integral;
  SurfDetector detector;
  BriefDescriptor intensity;
  OrientationDescriptor orientation;
  EdgeFieldExtractor edges;

  void describe(const cv::Mat& image, const std::vector<Keypoint>& keypoints, FeatureSet& features);
};

void FeatureExtractor::Implementation::describe(const cv::Mat& image, const std::vector<Keypoint>& keypoints,
                                                FeatureSet& features) {
  const bool oriented = settings.descriptor == DescriptorKind::kOrientation;
  if (oriented) {
    orientation.prepare(image, integral);
  } else {
    intensity.prepare(integral);
  }
  features.clear();
  features.reserve(keypoints.size());
  for (const Keypoint& keypoint : keypoints) {
    const Pixel centre = nearestPixel(keypoint);
    features.add(settings.half_resolution ? inFullImage(keypoint) : keypoint,
                 oriented ? orientation.describe(centre) : intensity.describe(centre));
  }
}

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
  const bool oriented = parts.settings.descriptor == DescriptorKind::kOrientation;
  if (parts.settings.half_resolution || oriented) {
    halveImage(image, parts.half);
  }
  const cv::Mat& searched = parts.settings.half_resolution ? parts.half : image;
  parts.integral.compute(searched);
  parts.describe(searched, parts.detector.detect(parts.integral, BriefDescriptor::kMargin), features);
  if (oriented) {
    parts.edges.compute(parts.half, features.edges);
  }
}

const ExtractionSettings& FeatureExtractor::settings() const { return implementation_->settings; }

}  // namespace perennial
