#include "core/features/hessian_pyramid.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/features/brute_force_hessian.h"
#include "core/features/synthetic_images.h"

namespace perennial {
namespace {

constexpr int kSizes[4][5] = {
    {9, 15, 21, 27, 33}, {15, 27, 39, 51, 63}, {27, 51, 75, 99, 123}, {51, 99, 147, 195, 243}};

HessianPyramid pyramidOf(const cv::Mat& image, int octaves, int layers) {
  IntegralImage integral;
  integral.compute(image);
  HessianPyramid pyramid(octaves, layers);
  pyramid.compute(integral);
  return pyramid;
}

TEST(HessianPyramid, hasTheStandardFilterSizes) {
  const HessianPyramid pyramid(4, 3);
  ASSERT_EQ(pyramid.layersPerOctave(), 5);
  for (int octave = 0; octave < 4; ++octave) {
    for (int index = 0; index < 5; ++index) {
      EXPECT_EQ(pyramid.layer(octave, index).filter.size(), kSizes[octave][index]);
      EXPECT_EQ(pyramid.layer(octave, index).step, 1 << octave);
    }
  }
}

TEST(HessianPyramid, smallestFilterStandsForSigmaOnePointTwo) {
  EXPECT_FLOAT_EQ(scaleOfFilterSize(9.0F), 1.2F);
  EXPECT_FLOAT_EQ(scaleOfFilterSize(27.0F), 3.6F);
}

/// Every sample of one octave against the definition. The image is just large enough for all of its filters.
class ResponsesOfOctave : public ::testing::TestWithParam<int> {};

TEST_P(ResponsesOfOctave, equalTheBruteForceOnes) {
  const int octave = GetParam();
  const int largest = kSizes[octave][4];
  const cv::Mat image = texture(largest + 45, largest + 34, 7);
  const HessianPyramid pyramid = pyramidOf(image, octave + 1, 3);
  for (int index = 0; index < 5; ++index) {
    const ResponseLayer& layer = pyramid.layer(octave, index);
    const int size = kSizes[octave][index];
    const BruteForceHessian expected(image, size);
    int compared = 0;
    for (int j = 0; j < layer.rows; ++j) {
      for (int i = 0; i < layer.columns; ++i) {
        const int x = i * layer.step;
        const int y = j * layer.step;
        if (std::min({x, y, image.cols - 1 - x, image.rows - 1 - y}) < size / 2) {
          ASSERT_EQ(layer.row(j)[i], 0.0F) << "the filter does not fit here";
          continue;
        }
        const auto derivatives = expected.at(x, y);
        ASSERT_NEAR(layer.row(j)[i], derivatives.determinant(), 1e-6 * derivatives.magnitude() + 1e-12)
            << "filter " << size << " at " << x << ", " << y;
        ++compared;
      }
    }
    EXPECT_GT(compared, 10);
  }
}

INSTANTIATE_TEST_SUITE_P(HessianPyramid, ResponsesOfOctave, ::testing::Range(0, 4));

TEST(HessianPyramid, copiedLayersEqualComputedOnes) {
  const cv::Mat image = texture(200, 180, 8);
  for (const int layers : {1, 2, 3, 4, 6}) {
    const HessianPyramid pyramid = pyramidOf(image, 3, layers);
    for (int octave = 1; octave < 3; ++octave) {
      const ResponseLayer& layer = pyramid.layer(octave, 0);
      const BruteForceHessian expected(image, layer.filter.size());
      const int middle = layer.columns / 2;
      const auto derivatives = expected.at(middle * layer.step, 40 * layer.step / 2);
      EXPECT_NEAR(layer.row(20)[middle], derivatives.determinant(), 1e-6 * derivatives.magnitude() + 1e-12);
    }
  }
}

TEST(HessianPyramid, forgetsTheImageBefore) {
  HessianPyramid used(4, 3);
  IntegralImage integral;
  for (const cv::Size size : {cv::Size(400, 300), cv::Size(300, 400), cv::Size(5, 5), cv::Size(0, 0)}) {
    const cv::Mat image = size.area() > 0 ? texture(size.width, size.height, 9) : cv::Mat();
    integral.compute(image);
    used.compute(integral);
    const HessianPyramid fresh = pyramidOf(image, 4, 3);
    for (int octave = 0; octave < 4; ++octave) {
      for (int index = 0; index < 5; ++index) {
        EXPECT_EQ(used.layer(octave, index).responses, fresh.layer(octave, index).responses);
      }
    }
  }
}

}  // namespace
}  // namespace perennial
