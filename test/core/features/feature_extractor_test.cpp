#include "perennial/core/feature_extractor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <utility>

#include "core/features/synthetic_images.h"
#include "perennial/core/error.h"

namespace perennial {
namespace {

ExtractionSettings settingsFor(int features) {
  ExtractionSettings settings = ExtractionSettings::published();
  settings.features = features;
  return settings;
}

TEST(FeatureExtractor, givesTheNumberWanted) {
  const cv::Mat image = texture(752, 480, 61);
  for (const int features : {1, 50, 500, 1500}) {
    const FeatureSet found = FeatureExtractor(settingsFor(features)).extract(image);
    EXPECT_EQ(found.keypoints.size(), static_cast<std::size_t>(features));
    EXPECT_EQ(found.descriptors.size(), static_cast<std::size_t>(features));
  }
}

/// Strong blobs that cannot be described because they are near the edge must not take the places of others.
TEST(FeatureExtractor, countsOnlyWhatIsDescribed) {
  cv::Mat image(240, 320, CV_8UC1, cv::Scalar(20));
  for (int x = 45; x < 280; x += 40) {
    addBlob(image, x, 20.0, 3.0, 220.0);
    addBlob(image, x, 220.0, 3.0, 220.0);
    addBlob(image, x, 120.0, 3.0, 80.0);
  }
  const FeatureSet found = FeatureExtractor(settingsFor(6)).extract(image);
  ASSERT_EQ(found.size(), 6U);
  for (const Keypoint& keypoint : found.keypoints) {
    EXPECT_NEAR(keypoint.y, 120.0F, 0.5F);
  }
}

TEST(FeatureExtractor, everyFeatureLeavesRoomForItsPatch) {
  const FeatureSet found = FeatureExtractor(settingsFor(10000)).extract(texture(300, 200, 62));
  ASSERT_FALSE(found.empty());
  for (const Keypoint& keypoint : found.keypoints) {
    EXPECT_TRUE(keypoint.x >= 27.5F && keypoint.x <= 272.5F && keypoint.y >= 27.5F && keypoint.y <= 172.5F)
        << keypoint.x << ", " << keypoint.y;
  }
}

TEST(FeatureExtractor, isDeterministic) {
  const cv::Mat image = texture(400, 300, 63);
  FeatureExtractor extractor;
  const FeatureSet first = extractor.extract(image);
  EXPECT_EQ(extractor.extract(image), first);
  EXPECT_EQ(FeatureExtractor().extract(image.clone()), first);
}

TEST(FeatureExtractor, resultDoesNotDependOnEarlierImages) {
  FeatureExtractor used(settingsFor(200));
  for (int trial = 0; trial < 6; ++trial) {
    const double contrast = trial % 2 == 0 ? 30.0 : 1.0;
    const cv::Mat image = texture(300 + 20 * trial, 250, static_cast<std::uint64_t>(64 + trial), contrast);
    ASSERT_EQ(used.extract(image), FeatureExtractor(settingsFor(200)).extract(image)) << "image " << trial;
  }
}

TEST(FeatureExtractor, tinyImagesHaveNoFeatures) {
  FeatureExtractor extractor;
  EXPECT_TRUE(extractor.extract(cv::Mat()).empty());
  EXPECT_TRUE(extractor.extract(cv::Mat(0, 100, CV_8UC1)).empty());
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 500), cv::Size(500, 1), cv::Size(8, 8),
                              cv::Size(9, 9), cv::Size(34, 34), cv::Size(55, 300), cv::Size(300, 55)}) {
    EXPECT_TRUE(extractor.extract(noise(size.width, size.height, 65, 128.0, 60.0)).empty()) << size;
  }
}

TEST(FeatureExtractor, findsTheOnlyFeatureThatASmallImageHasRoomFor) {
  cv::Mat image(56, 56, CV_8UC1, cv::Scalar(30));
  addBlob(image, 28.0, 28.0, 2.5, 200.0);
  const FeatureSet found = FeatureExtractor(ExtractionSettings::published()).extract(image);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found.keypoints[0].x, 28.0F, 0.05F);
}

TEST(FeatureExtractor, everySizeIsTakenByOneInstance) {
  FeatureExtractor used;
  for (int size = 40; size < 140; size += 7) {
    for (const cv::Size shape : {cv::Size(size, 150), cv::Size(150, size)}) {
      const cv::Mat image = texture(shape.width, shape.height, static_cast<std::uint64_t>(size));
      ASSERT_EQ(used.extract(image), FeatureExtractor().extract(image)) << shape;
    }
  }
}

TEST(FeatureExtractor, constantAndNearlyConstantImagesHaveNoFeatures) {
  FeatureExtractor extractor;
  for (const int grey : {0, 128, 255}) {
    EXPECT_TRUE(extractor.extract(cv::Mat(300, 300, CV_8UC1, cv::Scalar(grey))).empty());
  }
  EXPECT_TRUE(extractor.extract(noise(752, 480, 66, 40.0, 1.0)).empty()) << "noise of a camera in the dark";
  ExtractionSettings all;
  all.min_response = 0.0;
  EXPECT_TRUE(FeatureExtractor(all).extract(cv::Mat(300, 300, CV_8UC1, cv::Scalar(80))).empty());
}

TEST(FeatureExtractor, takesPartOfALargerImage) {
  const cv::Mat large = texture(500, 400, 67);
  const cv::Mat part = large(cv::Rect(33, 21, 320, 240));
  ASSERT_FALSE(part.isContinuous());
  FeatureExtractor extractor;
  EXPECT_EQ(extractor.extract(part), extractor.extract(part.clone()));
}

TEST(FeatureExtractor, refusesOtherTypes) {
  FeatureExtractor extractor;
  for (const int type : {CV_8UC3, CV_16UC1, CV_32FC1, CV_8SC1, CV_8UC2}) {
    EXPECT_THROW(extractor.extract(cv::Mat(100, 100, type, cv::Scalar(1))), ImageError) << type;
  }
  const int sizes[] = {20, 20, 20};
  EXPECT_THROW(extractor.extract(cv::Mat(3, sizes, CV_8UC1, cv::Scalar(1))), ImageError);
  EXPECT_EQ(extractor.extract(texture(200, 200, 68)), FeatureExtractor().extract(texture(200, 200, 68)))
      << "still works after an error";
}

TEST(FeatureExtractor, moves) {
  FeatureExtractor first(settingsFor(77));
  FeatureExtractor second(std::move(first));
  EXPECT_EQ(second.settings().features, 77);
  const cv::Mat image = texture(200, 200, 69);
  EXPECT_EQ(second.extract(image), FeatureExtractor(settingsFor(77)).extract(image));
}

/// Wherever a shifted image shows the same keypoint, its descriptor is (nearly) the same.
TEST(FeatureExtractor, describesAShiftedImageNearlyTheSame) {
  const cv::Mat image = texture(500, 400, 70);
  FeatureExtractor extractor(settingsFor(400));
  const FeatureSet a = extractor.extract(image(cv::Rect(0, 0, 400, 300)));
  const FeatureSet b = extractor.extract(image(cv::Rect(24, 9, 400, 300)));
  int pairs = 0;
  int close = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < b.size(); ++k) {
      const float distance =
          std::hypot(b.keypoints[k].x + 24.0F - a.keypoints[i].x, b.keypoints[k].y + 9.0F - a.keypoints[i].y);
      if (distance < 0.5F) {
        ++pairs;
        close += hammingDistance(a.descriptors[i], b.descriptors[k]) <= 25 ? 1 : 0;
      }
    }
  }
  EXPECT_GE(pairs, 200);
  EXPECT_EQ(close, pairs);
}

/// Real images, where there are some: PERENNIAL_DATA names their folder.
TEST(FeatureExtractor, fillsTheNumberFromRealImages) {
  const char* const folder = std::getenv("PERENNIAL_DATA");
  const std::string file =
      std::string(folder != nullptr ? folder : PERENNIAL_DEFAULT_DATA) + "/michigan/0101.png";
  const cv::Mat image = cv::imread(file, cv::IMREAD_GRAYSCALE);
  if (image.empty()) {
    GTEST_SKIP() << "no real image at " << file << "; set PERENNIAL_DATA";
  }
  EXPECT_EQ(FeatureExtractor().extract(image).size(), 500U);
  // The strongest of the whole image; buckets take weak ones too where there is nothing better.
  FeatureExtractor extractor(ExtractionSettings::published());
  const FeatureSet found = extractor.extract(image);
  EXPECT_EQ(found.size(), 500U);
  EXPECT_GT(found.keypoints.back().response, 1e-4F);
  const auto large = std::count_if(found.keypoints.begin(), found.keypoints.end(),
                                   [](const Keypoint& keypoint) { return keypoint.scale > 5.0F; });
  EXPECT_GT(large, 10) << "features of the upper octaves";
}

}  // namespace
}  // namespace perennial
