#include <gtest/gtest.h>

#include <cmath>

#include "core/features/synthetic_images.h"
#include "perennial/core/feature_extractor.h"

/// How many features are found again, and how many are matched to the right one, after a known change of the
/// image. The shares required are 2 to 6 % below those measured. BRIEF patches have a fixed size, which is
/// why matching falls off at a magnification of 1.5, where detection does not.
namespace perennial {
namespace {

constexpr int kColumns = 480;
constexpr int kRows = 360;

/// The same texture as a function of the plane, seen at a given magnification and position.
cv::Mat view(double scale, double shift_x, double shift_y) {
  static const cv::Mat plane = texture(1000, 800, 51);
  const cv::Matx23d plane_to_view(scale, 0.0, -shift_x - 150.0 * scale, 0.0, scale, -shift_y - 150.0 * scale);
  cv::Mat image;
  cv::warpAffine(plane, image, plane_to_view, {kColumns, kRows}, cv::INTER_CUBIC);
  return image;
}

struct Agreement {
  int visible = 0;   ///< features of the first image that should be in the second
  int repeated = 0;  ///< of these: a feature of the second is within 2 px and a factor of 1.5 in scale
  int matched = 0;   ///< of these: the feature of the second with the nearest descriptor is within 3 px

  double repeatedShare() const { return static_cast<double>(repeated) / visible; }
  double matchedShare() const { return static_cast<double>(matched) / visible; }
};

std::size_t nearestDescriptor(const Descriptor& descriptor, const FeatureSet& features) {
  std::size_t nearest = 0;
  for (std::size_t k = 1; k < features.size(); ++k) {
    if (hammingDistance(descriptor, features.descriptors[k]) <
        hammingDistance(descriptor, features.descriptors[nearest])) {
      nearest = k;
    }
  }
  return nearest;
}

/// The strongest 200 of one image against the strongest 400 of the other, so that a change of rank is not
/// counted.
Agreement compare(const cv::Mat& first, const cv::Mat& second, double scale, double shift_x, double shift_y) {
  ExtractionSettings settings = ExtractionSettings::published();
  settings.features = 200;
  const FeatureSet a = FeatureExtractor(settings).extract(first);
  settings.features = 400;
  const FeatureSet b = FeatureExtractor(settings).extract(second);
  Agreement agreement;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double x = scale * a.keypoints[i].x - shift_x;
    const double y = scale * a.keypoints[i].y - shift_y;
    if (x < 60.0 || y < 60.0 || x > kColumns - 60.0 || y > kRows - 60.0) {
      continue;
    }
    ++agreement.visible;
    bool repeated = false;
    for (const Keypoint& other : b.keypoints) {
      const double ratio = other.scale / (scale * a.keypoints[i].scale);
      repeated = repeated || (std::hypot(other.x - x, other.y - y) < 2.0 && ratio < 1.5 && ratio > 1.0 / 1.5);
    }
    agreement.repeated += repeated ? 1 : 0;
    const Keypoint& match = b.keypoints[nearestDescriptor(a.descriptors[i], b)];
    agreement.matched += std::hypot(match.x - x, match.y - y) < 3.0 ? 1 : 0;
  }
  return agreement;
}

struct Change {
  const char* name;
  double scale;
  double shift_x;
  double shift_y;
  double least_repeated;
  double least_matched;
};

class Geometry : public ::testing::TestWithParam<Change> {};

TEST_P(Geometry, featuresAreFoundAgain) {
  const Change& change = GetParam();
  const Agreement agreement = compare(view(1.0, 0.0, 0.0), view(change.scale, change.shift_x, change.shift_y),
                                      change.scale, change.shift_x, change.shift_y);
  EXPECT_GE(agreement.visible, 60);
  EXPECT_GE(agreement.repeatedShare(), change.least_repeated);
  EXPECT_GE(agreement.matchedShare(), change.least_matched);
  RecordProperty("repeated_percent", static_cast<int>(100.0 * agreement.repeatedShare()));
  RecordProperty("matched_percent", static_cast<int>(100.0 * agreement.matchedShare()));
}

INSTANTIATE_TEST_SUITE_P(Repeatability, Geometry,
                         ::testing::Values(Change{"shift_by_8", 1.0, 8.0, 16.0, 0.98, 0.98},
                                           Change{"shift_by_37", 1.0, 37.0, -5.0, 0.95, 0.96},
                                           Change{"shift_by_half", 1.0, 10.5, 3.5, 0.88, 0.91},
                                           Change{"shift_by_a_quarter", 1.0, -20.25, 0.75, 0.89, 0.91},
                                           Change{"scale_1.1", 1.1, 10.0, 5.0, 0.87, 0.91},
                                           Change{"scale_1.25", 1.25, 40.0, 30.0, 0.83, 0.87},
                                           Change{"scale_1.5", 1.5, 80.0, 60.0, 0.85, 0.38}),
                         [](const auto& info) {
                           std::string name = info.param.name;
                           for (char& letter : name) {
                             letter = std::isalnum(static_cast<unsigned char>(letter)) != 0 ? letter : '_';
                           }
                           return name;
                         });

struct Light {
  double contrast;
  double brightness;
  double noise;
  double least_repeated;
  double least_matched;
};

class Illumination : public ::testing::TestWithParam<Light> {};

TEST_P(Illumination, featuresAreFoundAgain) {
  const Light& light = GetParam();
  const cv::Mat image = view(1.0, 0.0, 0.0);
  cv::Mat changed;
  image.convertTo(changed, CV_32F, light.contrast, light.brightness);
  cv::Mat grain(image.size(), CV_32F, cv::Scalar(0.0));
  if (light.noise > 0.0) {
    cv::RNG(52).fill(grain, cv::RNG::NORMAL, 0.0, light.noise);
  }
  changed += grain;
  changed.convertTo(changed, CV_8U);
  const Agreement agreement = compare(image, changed, 1.0, 0.0, 0.0);
  EXPECT_GE(agreement.repeatedShare(), light.least_repeated);
  EXPECT_GE(agreement.matchedShare(), light.least_matched);
  RecordProperty("repeated_percent", static_cast<int>(100.0 * agreement.repeatedShare()));
  RecordProperty("matched_percent", static_cast<int>(100.0 * agreement.matchedShare()));
}

INSTANTIATE_TEST_SUITE_P(
    Repeatability, Illumination,
    ::testing::Values(Light{1.0, 30.0, 0.0, 0.94, 0.95}, Light{1.0, -40.0, 0.0, 0.87, 0.91},
                      Light{0.5, 20.0, 0.0, 0.95, 0.96}, Light{0.1, 5.0, 0.0, 0.93, 0.93},
                      Light{1.4, -50.0, 0.0, 0.87, 0.91}, Light{0.4, 0.0, 4.0, 0.91, 0.92}));

}  // namespace
}  // namespace perennial
