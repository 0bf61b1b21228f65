#include "core/features/orientation_descriptor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/features/synthetic_images.h"
#include "perennial/core/feature_extractor.h"

namespace perennial {
namespace {

/// Grey levels rising by `slope` per px in a direction, about 128.
cv::Mat ramp(double angle, double slope) {
  cv::Mat image(40, 50, CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double along = (x - 25) * std::cos(angle) + (y - 20) * std::sin(angle);
      image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(128.0 + slope * along);
    }
  }
  return image;
}

/// The image's orientation by real arithmetic, from its definition in orientation_image.h.
class Reference {
 public:
  explicit Reference(const cv::Mat& image) {
    cv::Mat real;
    image.convertTo(real, CV_64F);
    const cv::Mat binomial = (cv::Mat_<double>(5, 1) << 1, 4, 6, 4, 1) / 16.0;
    cv::sepFilter2D(real, real, CV_64F, binomial, binomial, {-1, -1}, 0.0, cv::BORDER_REPLICATE);
    cv::Sobel(real, x_, CV_64F, 1, 0, 3, 1.0 / 8.0, 0.0, cv::BORDER_REPLICATE);
    cv::Sobel(real, y_, CV_64F, 0, 1, 3, 1.0 / 8.0, 0.0, cv::BORDER_REPLICATE);
  }
  double cosine(int x, int y) const {
    return 128.0 + 127.0 * (gx(x, y) * gx(x, y) - gy(x, y) * gy(x, y)) / sum(x, y);
  }
  double sine(int x, int y) const { return 128.0 + 254.0 * gx(x, y) * gy(x, y) / sum(x, y); }

 private:
  double gx(int x, int y) const { return x_.at<double>(y, x); }
  double gy(int x, int y) const { return y_.at<double>(y, x); }
  double sum(int x, int y) const { return gx(x, y) * gx(x, y) + gy(x, y) * gy(x, y) + 4.0; }

  cv::Mat x_;
  cv::Mat y_;
};

TEST(OrientationImages, areWhatTheirDefinitionSays) {
  for (const cv::Size size : {cv::Size(61, 47), cv::Size(5, 3), cv::Size(1, 9), cv::Size(64, 1)}) {
    const cv::Mat image = noise(size.width, size.height, 4, 128.0, 40.0);
    OrientationImages orientation;
    orientation.compute(image);
    const Reference reference(image);
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        // Rounded down, and the smoothed image to a sixteenth: some 0.04 of a gradient of 2 and more.
        ASSERT_NEAR(orientation.cosine().at<std::uint8_t>(y, x) + 0.5, reference.cosine(x, y), 3.0);
        ASSERT_NEAR(orientation.sine().at<std::uint8_t>(y, x) + 0.5, reference.sine(x, y), 3.0);
      }
    }
  }
}

TEST(OrientationImages, tellDirectionsNotContrasts) {
  constexpr double kPi = 3.14159265358979;
  for (const double degrees : {0.0, 20.0, 45.0, 90.0, 135.0, 160.0}) {
    for (const double slope : {4.0, -4.0}) {
      OrientationImages orientation;
      orientation.compute(ramp(degrees * kPi / 180.0, slope));
      const double strength = 127.0 * 16.0 / (16.0 + 4.0);
      EXPECT_NEAR(orientation.cosine().at<std::uint8_t>(20, 25),
                  128.0 + strength * std::cos(degrees * kPi / 90.0), 3.0);
      EXPECT_NEAR(orientation.sine().at<std::uint8_t>(20, 25),
                  128.0 + strength * std::sin(degrees * kPi / 90.0), 3.0);
    }
  }
}

TEST(OrientationImages, areNeutralWhereThereIsNoEdge) {
  OrientationImages orientation;
  for (const int grey : {0, 100, 255}) {
    orientation.compute(cv::Mat(20, 30, CV_8UC1, cv::Scalar(grey)));
    EXPECT_EQ(cv::countNonZero(orientation.cosine() != 128), 0);
    EXPECT_EQ(cv::countNonZero(orientation.sine() != 128), 0);
  }
  orientation.compute(cv::Mat());
  EXPECT_TRUE(orientation.cosine().empty());
}

Descriptor describe(const cv::Mat& image, const Pixel& centre) {
  IntegralImage integral;
  integral.compute(image);
  OrientationDescriptor descriptor;
  descriptor.prepare(image, integral);
  return descriptor.describe(centre);
}

double boxMean(const cv::Mat& image, int x, int y) {
  return cv::mean(image(cv::Rect(x - 4, y - 4, 9, 9)))[0];
}

bool isLess(const cv::Mat& image, const Pixel& centre, const BriefTest& test) {
  return boxMean(image, centre.x + test.x1, centre.y + test.y1) <
         boxMean(image, centre.x + test.x2, centre.y + test.y2);
}

TEST(OrientationDescriptor, comparesWhatItSays) {
  const cv::Mat image = texture(80, 70, 3);
  OrientationImages orientation;
  orientation.compute(image);
  for (const Pixel centre : {Pixel{28, 28}, Pixel{40, 35}, Pixel{52, 42}}) {
    const Descriptor descriptor = describe(image, centre);
    for (std::size_t i = 0; i < Descriptor::kBits; ++i) {
      const BriefTest& test = kBriefPattern[i];
      bool expected = isLess(i % 2 == 0 ? orientation.cosine() : orientation.sine(), centre, test);
      if (i % 8 < 2) {
        expected = isLess(image, centre, test) != isLess(image, centre, kBriefPattern[(i + 128) % 256]);
      }
      ASSERT_EQ((descriptor.words[i / 64] >> (i % 64) & 1U) == 1U, expected) << "bit " << i;
    }
  }
}

TEST(OrientationDescriptor, hardlyChangesWhenContrastsTurnOver) {
  const cv::Mat image = texture(120, 100, 5, 12.0);
  const cv::Mat negative = 255 - image;
  const Descriptor original = describe(image, {60, 50});
  EXPECT_LE(hammingDistance(describe(negative, {60, 50}), original), 10) << "rounding, and equal sums";
  const auto brief = [](const cv::Mat& of) {
    IntegralImage integral;
    integral.compute(of);
    BriefDescriptor descriptor;
    descriptor.prepare(integral);
    return descriptor.describe({60, 50});
  };
  EXPECT_GT(hammingDistance(brief(negative), brief(image)), 240) << "what BRIEF makes of it";
}

TEST(OrientationDescriptor, hardlyChangesWithBrightness) {
  const cv::Mat image = texture(100, 100, 5, 12.0);
  EXPECT_EQ(describe(image + cv::Scalar(25), {50, 50}), describe(image, {50, 50}));
}

TEST(OrientationDescriptor, differsBetweenPlaces) {
  const cv::Mat image = texture(300, 300, 6);
  EXPECT_GT(hammingDistance(describe(image, {60, 60}), describe(image, {220, 230})), 70);
}

TEST(OrientationDescriptor, followsTheImageSize) {
  OrientationDescriptor used;
  for (const cv::Size size : {cv::Size(150, 90), cv::Size(90, 150), cv::Size(3, 3), cv::Size(60, 60)}) {
    const cv::Mat image = texture(size.width, size.height, 7);
    IntegralImage integral;
    integral.compute(image);
    used.prepare(image, integral);
    if (OrientationDescriptor::kMargin.fits({30, 30}, size.width, size.height)) {
      EXPECT_EQ(used.describe({30, 30}), describe(image, {30, 30})) << size;
    }
  }
}

TEST(OrientationDescriptor, isWhatTheExtractorUsesUnlessIntensityIsAsked) {
  const cv::Mat image = texture(200, 160, 8);
  ExtractionSettings settings = ExtractionSettings::published();
  const FeatureSet intensity = FeatureExtractor(settings).extract(image);
  settings.descriptor = DescriptorKind::kOrientation;
  const FeatureSet orientation = FeatureExtractor(settings).extract(image);
  ASSERT_EQ(intensity.keypoints, orientation.keypoints);
  ASSERT_GT(orientation.size(), 20U);
  for (std::size_t i = 0; i < orientation.size(); ++i) {
    EXPECT_EQ(orientation.descriptors[i], describe(image, nearestPixel(orientation.keypoints[i])));
  }
  EXPECT_NE(intensity.descriptors, orientation.descriptors);
}

}  // namespace
}  // namespace perennial
