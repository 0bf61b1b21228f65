#include "core/features/surf_detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/features/brief_descriptor.h"
#include "core/features/synthetic_images.h"

namespace perennial {
namespace {

constexpr PatchMargin kMargin = BriefDescriptor::kMargin;

std::vector<Keypoint> detect(SurfDetector& detector, const cv::Mat& image) {
  IntegralImage integral;
  integral.compute(image);
  return detector.detect(integral, kMargin);
}

std::vector<Keypoint> detectAfresh(const ExtractionSettings& settings, const cv::Mat& image) {
  SurfDetector detector(settings);
  return detect(detector, image);
}

ExtractionSettings settingsFor(int features, double min_response = 3e-6) {
  ExtractionSettings settings = ExtractionSettings::published();
  settings.features = features;
  settings.min_response = min_response;
  return settings;
}

/// Rich, poor, empty, small and noisy images: the search starts too high and too low in turn.
std::vector<cv::Mat> variedImages() {
  std::vector<cv::Mat> images;
  images.push_back(texture(400, 300, 31));
  images.push_back(texture(400, 300, 32, 1.5));
  images.push_back(cv::Mat(300, 400, CV_8UC1, cv::Scalar(0)));
  images.push_back(texture(320, 310, 33));
  images.push_back(noise(400, 300, 34, 30.0, 1.0));
  images.push_back(texture(70, 65, 35));
  images.push_back(texture(400, 300, 36, 40.0));
  images.push_back(texture(400, 300, 37, 4.0));
  return images;
}

TEST(SurfDetector, resultDoesNotDependOnEarlierImages) {
  const std::vector<cv::Mat> images = variedImages();
  for (const int features : {20, 150, 2000}) {
    SurfDetector used(settingsFor(features));
    cv::RNG random(41);
    for (int trial = 0; trial < 30; ++trial) {
      const auto which = static_cast<std::size_t>(random.uniform(0, static_cast<int>(images.size())));
      const std::vector<Keypoint> keypoints = detect(used, images[which]);
      ASSERT_EQ(keypoints, detectAfresh(settingsFor(features), images[which]))
          << features << " features, image " << which << " in trial " << trial;
    }
  }
}

TEST(SurfDetector, thresholdFollowsTheImages) {
  SurfDetector detector(settingsFor(100));
  const float lowest = detector.threshold();
  const cv::Mat rich = texture(400, 300, 42);
  const std::vector<Keypoint> keypoints = detect(detector, rich);
  ASSERT_EQ(keypoints.size(), 100U);
  const float risen = detector.threshold();
  EXPECT_GT(risen, 10.0F * lowest) << "the search should not start at the bottom again";
  EXPECT_LE(risen, keypoints.back().response) << "the same image should be done in one search";
  EXPECT_EQ(detect(detector, rich), keypoints);
  EXPECT_EQ(detector.threshold(), risen);
  detect(detector, cv::Mat(300, 400, CV_8UC1, cv::Scalar(7)));
  EXPECT_EQ(detector.threshold(), lowest);
}

TEST(SurfDetector, fewerFeaturesAreAPrefixOfMore) {
  const cv::Mat image = texture(400, 300, 43);
  const std::vector<Keypoint> many = detectAfresh(settingsFor(400), image);
  ASSERT_EQ(many.size(), 400U);
  for (const int features : {1, 10, 399}) {
    const std::vector<Keypoint> few = detectAfresh(settingsFor(features), image);
    EXPECT_EQ(few, std::vector<Keypoint>(many.begin(), many.begin() + features));
  }
}

TEST(SurfDetector, ordersByResponseThenPlace) {
  cv::Mat image(200, 300, CV_8UC1, cv::Scalar(30));
  for (const cv::Point centre :
       {cv::Point(220, 60), cv::Point(60, 60), cv::Point(140, 140), cv::Point(60, 140)}) {
    addBlob(image, centre.x, centre.y, 3.0, 150.0);
  }
  const std::vector<Keypoint> keypoints = detectAfresh(settingsFor(4), image);
  ASSERT_EQ(keypoints.size(), 4U);
  EXPECT_EQ(keypoints[0].response, keypoints[3].response) << "the blobs are equal";
  const std::vector<cv::Point> expected = {{60, 60}, {220, 60}, {60, 140}, {140, 140}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(keypoints[i].x, static_cast<float>(expected[i].x), 0.01F);
    EXPECT_NEAR(keypoints[i].y, static_cast<float>(expected[i].y), 0.01F);
  }
  const std::vector<Keypoint> many = detectAfresh(settingsFor(5000, 0.0), texture(400, 300, 44));
  EXPECT_TRUE(std::is_sorted(many.begin(), many.end(),
                             [](const Keypoint& a, const Keypoint& b) { return a.response > b.response; }));
}

TEST(SurfDetector, nothingIsWeakerThanTheFloor) {
  const cv::Mat image = texture(300, 250, 45, 8.0);
  const std::vector<Keypoint> all = detectAfresh(settingsFor(10000, 0.0), image);
  const double floor = all[all.size() / 2].response;
  const std::vector<Keypoint> strong = detectAfresh(settingsFor(10000, floor), image);
  EXPECT_EQ(strong.size(), all.size() / 2 + 1);
  EXPECT_GE(strong.back().response, static_cast<float>(floor));
}

TEST(SurfDetector, aBlobOfAnySizeIsFoundOnce) {
  for (double sigma = 2.2; sigma < 15.0; sigma *= 1.1) {
    cv::Mat image(360, 360, CV_8UC1, cv::Scalar(30));
    addBlob(image, 181.0, 178.0, sigma, 180.0);
    const std::vector<Keypoint> keypoints = detectAfresh(settingsFor(100, 1e-3), image);
    int same = 0;
    for (const Keypoint& keypoint : keypoints) {
      const double ratio = keypoint.scale / sigma;
      same += std::hypot(keypoint.x - 181.0, keypoint.y - 178.0) < 0.5 * sigma && ratio > 0.6 && ratio < 1.6
                  ? 1
                  : 0;
    }
    EXPECT_EQ(same, 1) << "sigma " << sigma;
  }
}

/// Without the filter some 200 of these 2000 keypoints have such a neighbour. One octave may hold two maxima
/// that refinement moves towards each other; there is one such pair here.
TEST(SurfDetector, octavesDoNotRepeatEachOther) {
  const cv::Mat image = texture(500, 400, 46);
  const std::vector<Keypoint> keypoints = detectAfresh(settingsFor(10000, 0.0), image);
  int close = 0;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    for (std::size_t k = i + 1; k < keypoints.size(); ++k) {
      const float ratio = keypoints[i].scale / keypoints[k].scale;
      const float distance = std::hypot(keypoints[i].x - keypoints[k].x, keypoints[i].y - keypoints[k].y);
      close += distance < 1.0F && ratio < 1.2F && ratio > 1.0F / 1.2F ? 1 : 0;
    }
  }
  EXPECT_GT(keypoints.size(), 1000U);
  EXPECT_LE(close, 2);
}

/// The first octave samples every pixel: with it alone, a moved image gives the same keypoints, moved.
TEST(SurfDetector, movesWithTheImage) {
  const cv::Mat image = texture(420, 330, 47);
  ExtractionSettings settings = settingsFor(10000, 0.0);
  settings.octaves = 1;
  const std::vector<Keypoint> original = detectAfresh(settings, image(cv::Rect(0, 0, 400, 300)));
  const std::vector<Keypoint> moved = detectAfresh(settings, image(cv::Rect(7, 11, 400, 300)));
  int compared = 0;
  for (const Keypoint& keypoint : original) {
    if (keypoint.x < 40.0F || keypoint.x > 360.0F || keypoint.y < 45.0F || keypoint.y > 260.0F) {
      continue;
    }
    const bool found = std::any_of(moved.begin(), moved.end(), [&](const Keypoint& other) {
      return other.response == keypoint.response && std::abs(other.x + 7.0F - keypoint.x) < 1e-3F &&
             std::abs(other.y + 11.0F - keypoint.y) < 1e-3F && std::abs(other.scale - keypoint.scale) < 1e-4F;
    });
    EXPECT_TRUE(found) << keypoint.x << ", " << keypoint.y;
    ++compared;
  }
  EXPECT_GT(compared, 200);
}

}  // namespace
}  // namespace perennial
