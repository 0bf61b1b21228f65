#include "core/features/integral_image.h"

#include <gtest/gtest.h>

#include "core/features/synthetic_images.h"

namespace perennial {
namespace {

std::uint32_t boxSum(const IntegralImage& integral, int x0, int y0, int x1, int y1) {
  return (integral.row(y1)[x1] - integral.row(y0)[x1]) - (integral.row(y1)[x0] - integral.row(y0)[x0]);
}

TEST(IntegralImage, sumsBoxes) {
  const cv::Mat image = noise(37, 23, 1, 128.0, 60.0);
  IntegralImage integral;
  integral.compute(image);
  cv::RNG random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const int x0 = random.uniform(0, 37);
    const int y0 = random.uniform(0, 23);
    const int x1 = random.uniform(x0, 38);
    const int y1 = random.uniform(y0, 24);
    const double expected = x0 < x1 && y0 < y1 ? cv::sum(image(cv::Rect(x0, y0, x1 - x0, y1 - y0)))[0] : 0.0;
    ASSERT_EQ(boxSum(integral, x0, y0, x1, y1), expected) << x0 << " " << y0 << " " << x1 << " " << y1;
  }
}

TEST(IntegralImage, followsTheImageSize) {
  IntegralImage integral;
  for (const cv::Size size : {cv::Size(20, 10), cv::Size(1, 1), cv::Size(0, 0), cv::Size(10, 30)}) {
    const cv::Mat image(size, CV_8UC1, cv::Scalar(3));
    integral.compute(image);
    EXPECT_EQ(integral.columns(), size.width);
    EXPECT_EQ(integral.rows(), size.height);
    EXPECT_EQ(integral.row(size.height)[size.width], 3U * static_cast<std::uint32_t>(size.area()));
  }
}

TEST(IntegralImage, boxesAreRightWhereTheTableWrapsAround) {
  const cv::Mat image(4200, 4200, CV_8UC1, cv::Scalar(255));  // sums to more than 2^32
  IntegralImage integral;
  integral.compute(image);
  ASSERT_GT(255.0 * 4200.0 * 4200.0, 4294967296.0);
  EXPECT_EQ(boxSum(integral, 4000, 4000, 4200, 4200), 255U * 200U * 200U);
  EXPECT_EQ(boxSum(integral, 10, 4100, 4100, 4200), 255U * 4090U * 100U);
}

}  // namespace
}  // namespace perennial
