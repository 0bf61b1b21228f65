#include "perennial/core/evaluation/disturbance.h"

#include <gtest/gtest.h>

#include "core/features/synthetic_images.h"
#include "perennial/core/error.h"

namespace perennial {
namespace {

double shareThatDiffers(const cv::Mat& a, const cv::Mat& b) {
  return static_cast<double>(cv::countNonZero(a != b)) / static_cast<double>(a.total());
}

cv::Mat disturbed(const cv::Mat& image, const char* how, std::uint64_t seed = 0) {
  return perennial::disturbed(image, Disturbance::parse(how), seed);
}

TEST(Disturbance, coversTheShareItSays) {
  const cv::Mat image = texture(400, 300, 5);
  for (const char* how : {"cover=0.1", "cover=0.4"}) {
    const double share = Disturbance::parse(how).amount;
    EXPECT_NEAR(shareThatDiffers(image, disturbed(image, how)), share, 0.03 * share + 0.01);
  }
  EXPECT_EQ(shareThatDiffers(image, disturbed(image, "cover=0")), 0.0);
  EXPECT_GT(shareThatDiffers(disturbed(image, "cover=0.2", 1), disturbed(image, "cover=0.2", 2)), 0.1);
  EXPECT_EQ(shareThatDiffers(disturbed(image, "cover=0.2", 1), disturbed(image, "cover=0.2", 1)), 0.0);
}

TEST(Disturbance, saturatesOneSide) {
  const cv::Mat white = disturbed(texture(400, 300, 6), "saturate=0.5") == 255;
  EXPECT_EQ(cv::countNonZero(white.colRange(0, 200)) == 60000,
            cv::countNonZero(white.colRange(200, 400)) < 60000);
}

TEST(Disturbance, movesTheSceneAsTheCameraTilts) {
  const cv::Mat image = texture(400, 300, 7);
  // 400 px * 0.714 * tan(4 degrees) = 19.97 px downwards
  const cv::Mat pitched = disturbed(image, "pitch=4");
  EXPECT_LT(cv::norm(pitched.rowRange(30, 300), image.rowRange(10, 280), cv::NORM_L1) / (270 * 400), 1.0);
  const cv::Mat rolled = disturbed(image, "roll=90");
  EXPECT_NEAR(rolled.at<std::uint8_t>(150, 250), image.at<std::uint8_t>(200, 199), 25) << "counter-clockwise";
}

TEST(Disturbance, blursAlongTheRowsOnly) {
  cv::Mat point(21, 41, CV_8UC1, cv::Scalar(0));
  point.at<std::uint8_t>(10, 20) = 200;
  const cv::Mat blurred = disturbed(point, "blur=5");
  EXPECT_EQ(cv::countNonZero(blurred), 5);
  EXPECT_EQ(cv::countNonZero(blurred.row(10)), 5);
}

TEST(Disturbance, refusesWhatMakesNoSense) {
  for (const char* how : {"", "cover", "cover=", "cover=1.5", "cover=-1", "fog=0.5", "blur=x", "roll=nan"}) {
    EXPECT_THROW(Disturbance::parse(how), ParameterError) << how;
  }
}

}  // namespace
}  // namespace perennial
