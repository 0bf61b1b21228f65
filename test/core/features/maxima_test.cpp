#include "core/features/maxima.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>

#include "core/features/brute_force_hessian.h"
#include "core/features/synthetic_images.h"

namespace perennial {
namespace {

using Place = std::tuple<int, int, int>;  // layer, i, j

IntegralImage integralOf(const cv::Mat& image) {
  IntegralImage integral;
  integral.compute(image);
  return integral;
}

HessianPyramid pyramidOf(const cv::Mat& image, int octaves) {
  HessianPyramid pyramid(octaves, 3);
  pyramid.compute(integralOf(image));
  return pyramid;
}

/// Responses of one octave by definition, NaN where a filter does not fit.
class BruteForceOctave {
 public:
  BruteForceOctave(const cv::Mat& image, int octave) : step_(1 << octave) {
    for (int index = 0; index < 5; ++index) {
      layers_.push_back(responses(image, 3 * (2 * step_ * (index + 1) + 1)));
    }
  }

  double at(int layer, int i, int j) const { return layers_[static_cast<std::size_t>(layer)](j, i); }
  int columns() const { return layers_[0].cols; }
  int rows() const { return layers_[0].rows; }

  /// The greatest of the 26 neighbours; NaN when one of them is.
  double greatestNeighbour(int layer, int i, int j) const {
    double greatest = -std::numeric_limits<double>::infinity();
    for (int n = 0; n < 27; ++n) {
      const double value = at(layer + n / 9 - 1, i + n % 3 - 1, j + n / 3 % 3 - 1);
      if (n != 13 && !(value <= greatest)) {
        greatest = value;
      }
      if (std::isnan(greatest)) {
        break;
      }
    }
    return greatest;
  }

 private:
  cv::Mat1d responses(const cv::Mat& image, int size) const {
    cv::Mat1d layer((image.rows + step_ - 1) / step_, (image.cols + step_ - 1) / step_,
                    std::numeric_limits<double>::quiet_NaN());
    const BruteForceHessian hessian(image, size);
    for (int j = 0; j < layer.rows; ++j) {
      for (int i = 0; i < layer.cols; ++i) {
        const int x = i * step_;
        const int y = j * step_;
        if (std::min({x, y, image.cols - 1 - x, image.rows - 1 - y}) >= size / 2) {
          layer(j, i) = hessian.at(x, y).determinant();
        }
      }
    }
    return layer;
  }

  int step_;
  std::vector<cv::Mat1d> layers_;
};

class MaximaOfOctave : public ::testing::TestWithParam<int> {};

/// Responses are float, the oracle's double: a place may differ only where two responses are equal to 5
/// digits.
TEST_P(MaximaOfOctave, areTheBruteForceOnes) {
  const int octave = GetParam();
  const int largest = 3 * (2 * (1 << octave) * 5 + 1);
  const cv::Mat image = texture(largest + 80, largest + 70, 17);
  std::vector<Maximum> maxima;
  findMaxima(pyramidOf(image, octave + 1), 1e-6F, maxima);
  std::set<Place> found;
  for (const Maximum& maximum : maxima) {
    if (maximum.octave == octave) {
      found.insert({maximum.layer, maximum.i, maximum.j});
    }
  }
  const BruteForceOctave expected(image, octave);
  int clear = 0;
  for (int layer = 1; layer <= 3; ++layer) {
    for (int j = 1; j + 1 < expected.rows(); ++j) {
      for (int i = 1; i + 1 < expected.columns(); ++i) {
        const double value = expected.at(layer, i, j);
        const double other = std::max(expected.greatestNeighbour(layer, i, j), 1e-6);
        const bool was_found = found.count({layer, i, j}) == 1;
        if (value > other + 1e-5 * value) {
          EXPECT_TRUE(was_found) << "missing: layer " << layer << " at sample " << i << ", " << j;
          ++clear;
        } else if (was_found) {
          EXPECT_GT(value, other - 1e-5 * value)
              << "wrong: layer " << layer << " at sample " << i << ", " << j;
        }
      }
    }
  }
  EXPECT_GE(clear, octave == 3 ? 1 : 5);
  EXPECT_GE(static_cast<int>(found.size()), clear);
}

INSTANTIATE_TEST_SUITE_P(Maxima, MaximaOfOctave, ::testing::Range(0, 4));

TEST(Maxima, lowerThresholdOnlyAdds) {
  const HessianPyramid pyramid = pyramidOf(texture(300, 200, 18), 3);
  std::vector<Maximum> all;
  findMaxima(pyramid, 1e-6F, all);
  for (const float threshold : {1e-5F, 1e-4F, 1e-3F}) {
    std::vector<Maximum> some;
    findMaxima(pyramid, threshold, some);
    const auto strong =
        std::count_if(all.begin(), all.end(), [&](const Maximum& m) { return m.response >= threshold; });
    EXPECT_EQ(static_cast<std::ptrdiff_t>(some.size()), strong);
    EXPECT_LT(some.size(), all.size());
  }
}

/// A blob between samples has two or four equal greatest responses.
TEST(Maxima, findsASymmetricBlobOnce) {
  for (const double shift : {0.0, 0.5}) {
    cv::Mat image(100, 100, CV_8UC1, cv::Scalar(20));
    addBlob(image, 50.0 + shift, 50.0 + shift, 2.5, 200.0);
    std::vector<Maximum> maxima;
    findMaxima(pyramidOf(image, 1), 1e-3F, maxima);
    ASSERT_EQ(maxima.size(), 1U) << "blob at " << 50.0 + shift;
    const auto keypoint = refine(pyramidOf(image, 1), integralOf(image), maxima[0]);
    ASSERT_TRUE(keypoint);
    EXPECT_NEAR(keypoint->x, 50.0 + shift, 0.1);
    EXPECT_NEAR(keypoint->y, 50.0 + shift, 0.1);
  }
}

/// Position and scale of isolated Gaussian blobs, dark and bright, between samples. A box filter of lobe l
/// has the second moment of a Gaussian of sigma = l / 2, which by the convention of the paper is called 0.4
/// l: the scale of a blob is found 0.8 times its sigma, less a little because lobes are wider than high.
TEST(Maxima, refinementFindsBlobsBetweenSamples) {
  for (const double sigma : {2.5, 3.0, 4.0, 5.5, 7.0}) {
    for (const double height : {120.0, -120.0}) {
      cv::Mat image(160, 160, CV_8UC1, cv::Scalar(128));
      addBlob(image, 80.3, 79.6, sigma, height);
      const HessianPyramid pyramid = pyramidOf(image, 2);
      std::vector<Maximum> maxima;
      findMaxima(pyramid, 1e-3F, maxima);
      ASSERT_FALSE(maxima.empty()) << "sigma " << sigma;
      const auto strongest =
          std::max_element(maxima.begin(), maxima.end(),
                           [](const Maximum& a, const Maximum& b) { return a.response < b.response; });
      const auto keypoint = refine(pyramid, integralOf(image), *strongest);
      ASSERT_TRUE(keypoint) << "sigma " << sigma;
      EXPECT_NEAR(keypoint->x, 80.3, 0.25) << "sigma " << sigma;
      EXPECT_NEAR(keypoint->y, 79.6, 0.25) << "sigma " << sigma;
      EXPECT_NEAR(keypoint->scale, 0.77 * sigma, 0.1 * sigma);
      EXPECT_EQ(keypoint->response, strongest->response);
    }
  }
}

/// A ridge that only just has a maximum on it moves far when it is refined: not a blob.
TEST(Maxima, refinementStaysWithinASample) {
  const cv::Mat image = texture(300, 260, 19);
  const HessianPyramid pyramid = pyramidOf(image, 3);
  std::vector<Maximum> maxima;
  findMaxima(pyramid, 1e-6F, maxima);
  const IntegralImage integral = integralOf(image);
  int kept = 0;
  for (const Maximum& maximum : maxima) {
    const auto keypoint = refine(pyramid, integral, maximum);
    if (keypoint) {
      const int step = 1 << maximum.octave;
      EXPECT_LT(std::abs(keypoint->x - static_cast<float>(maximum.i * step)), static_cast<float>(step));
      EXPECT_LT(std::abs(keypoint->y - static_cast<float>(maximum.j * step)), static_cast<float>(step));
      ++kept;
    }
  }
  EXPECT_GT(kept, static_cast<int>(maxima.size()) * 8 / 10);
}

TEST(Maxima, aConstantImageHasNone) {
  std::vector<Maximum> maxima;
  findMaxima(pyramidOf(cv::Mat(200, 200, CV_8UC1, cv::Scalar(99)), 4), std::numeric_limits<float>::min(),
             maxima);
  EXPECT_TRUE(maxima.empty());
}

}  // namespace
}  // namespace perennial
