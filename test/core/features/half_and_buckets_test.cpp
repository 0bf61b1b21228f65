#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/features/half_image.h"
#include "core/features/synthetic_images.h"
#include "perennial/core/feature_extractor.h"

namespace perennial {
namespace {

ExtractionSettings buckets(int columns, int rows) {
  ExtractionSettings settings = ExtractionSettings::published();
  settings.features = 200;
  settings.bucket_columns = columns;
  settings.bucket_rows = rows;
  return settings;
}

TEST(HalfImage, isTheRoundedMeanOfFour) {
  const cv::Mat image = (cv::Mat_<std::uint8_t>(3, 5) << 0, 1, 255, 255, 9, 1, 0, 255, 254, 9, 9, 9, 9, 9, 9);
  cv::Mat half;
  halveImage(image, half);
  ASSERT_EQ(half.size(), cv::Size(2, 1));
  EXPECT_EQ(half.at<std::uint8_t>(0, 0), 1);    // 0.5
  EXPECT_EQ(half.at<std::uint8_t>(0, 1), 255);  // 254.75
}

TEST(HalfResolution, keypointsAreInTheFullImage) {
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(60));
  addBlob(image, 320.0, 200.0, 8.0, 150.0);
  ExtractionSettings settings = ExtractionSettings::published();
  settings.half_resolution = true;
  const FeatureSet features = FeatureExtractor(settings).extract(image);
  ASSERT_FALSE(features.empty());
  EXPECT_NEAR(features.keypoints[0].x, 320.0F, 0.5F);
  EXPECT_NEAR(features.keypoints[0].y, 200.0F, 0.5F);
  EXPECT_NEAR(features.keypoints[0].scale, 8.0F / std::sqrt(2.0F), 0.5F)
      << "where the Hessian of a Gaussian peaks";
}

TEST(Buckets, spreadFeaturesOverTheImage) {
  // Strong texture in the left third only: without buckets everything is found there.
  cv::Mat image = texture(640, 480, 3, 4.0);
  texture(640, 480, 4, 40.0)(cv::Rect(0, 0, 213, 480)).copyTo(image(cv::Rect(0, 0, 213, 480)));
  const auto shareInLeftThird = [&](const ExtractionSettings& settings) {
    const FeatureSet features = FeatureExtractor(settings).extract(image);
    EXPECT_EQ(features.size(), 200U);
    int left = 0;
    for (const Keypoint& keypoint : features.keypoints) {
      left += keypoint.x < 213.0F ? 1 : 0;
    }
    return left / 200.0;
  };
  EXPECT_GT(shareInLeftThird(buckets(1, 1)), 0.9);
  EXPECT_LT(shareInLeftThird(buckets(8, 4)), 0.45);
}

TEST(Buckets, eachHasItsStrongestFirst) {
  const cv::Mat image = texture(640, 480, 5);
  const FeatureSet few = FeatureExtractor(buckets(8, 4)).extract(image);
  ExtractionSettings all = buckets(1, 1);
  all.features = 10000;
  const FeatureSet every = FeatureExtractor(all).extract(image);
  // Per bucket: the kept ones are the strongest of all, and no two buckets differ by more than one while both
  // have more.
  const auto bucketOf = [](const Keypoint& keypoint) {
    return std::make_pair(std::lround(keypoint.x) * 8 / 640, std::lround(keypoint.y) * 4 / 480);
  };
  std::map<std::pair<long, long>, std::vector<float>> kept;
  std::map<std::pair<long, long>, std::vector<float>> there;
  for (const Keypoint& keypoint : few.keypoints) {
    kept[bucketOf(keypoint)].push_back(keypoint.response);
  }
  for (const Keypoint& keypoint : every.keypoints) {
    there[bucketOf(keypoint)].push_back(keypoint.response);
  }
  std::size_t most = 0;
  for (const auto& bucket : kept) {
    most = std::max(most, bucket.second.size());
  }
  for (const auto& [bucket, responses] : there) {
    const auto& mine = kept[bucket];
    EXPECT_GE(mine.size() + 1, std::min(most, responses.size() + 1));
    EXPECT_TRUE(std::equal(mine.begin(), mine.end(), responses.begin()));
  }
  EXPECT_TRUE(std::is_sorted(few.keypoints.begin(), few.keypoints.end(),
                             [](const Keypoint& a, const Keypoint& b) { return a.response > b.response; }));
}

TEST(Buckets, doNotDependOnEarlierImages) {
  FeatureExtractor used(buckets(16, 8));
  used.extract(texture(640, 480, 6, 60.0));
  const cv::Mat image = texture(640, 480, 7, 10.0);
  EXPECT_EQ(used.extract(image), FeatureExtractor(buckets(16, 8)).extract(image));
}

TEST(ExtractionSettings, resolutionAndBucketsAreDescribedWhenSet) {
  EXPECT_EQ(ExtractionSettings::published().describe().find("half"), std::string::npos);
  EXPECT_EQ(ExtractionSettings::published().describe().find("buckets"), std::string::npos);
  ExtractionSettings settings = buckets(16, 8);
  settings.half_resolution = true;
  EXPECT_NE(settings.describe().find(" half_resolution=1 buckets=16x8"), std::string::npos);
  EXPECT_NE(buckets(16, 8).describe(), buckets(8, 16).describe());
}

}  // namespace
}  // namespace perennial
