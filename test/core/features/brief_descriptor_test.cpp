#include "core/features/brief_descriptor.h"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "core/features/synthetic_images.h"

namespace perennial {
namespace {

/// The generator that brief_pattern.h describes.
class PatternGenerator {
 public:
  BriefTest next() {
    BriefTest test{};
    do {
      test.x1 = coordinate();
      test.y1 = coordinate();
      test.x2 = coordinate();
      test.y2 = coordinate();
    } while (test.x1 == test.x2 && test.y1 == test.y2);
    return test;
  }

 private:
  std::int64_t random16() {
    state_ = 6364136223846793005ULL * state_ + 1442695040888963407ULL;
    return static_cast<std::int64_t>(state_ >> 48);
  }

  std::int8_t coordinate() {
    double value = 0.0;
    do {
      std::int64_t sum = -393210;
      for (int i = 0; i < 12; ++i) {
        sum += random16();
      }
      value = std::floor(static_cast<double>(sum) * 96.0 / 655360.0 + 0.5);
    } while (value < -24.0 || value > 23.0);
    return static_cast<std::int8_t>(value);
  }

  std::uint64_t state_ = 0;
};

TEST(BriefPattern, isTheOneThatItsDescriptionMakes) {
  PatternGenerator generator;
  for (std::size_t i = 0; i < kBriefPattern.size(); ++i) {
    const BriefTest made = generator.next();
    const BriefTest& stored = kBriefPattern[i];
    EXPECT_EQ(std::tie(stored.x1, stored.y1, stored.x2, stored.y2),
              std::tie(made.x1, made.y1, made.x2, made.y2))
        << "test " << i;
  }
}

TEST(BriefPattern, isIsotropicAndWithoutRepetition) {
  double squares_x = 0.0;
  double squares_y = 0.0;
  std::set<std::tuple<int, int, int, int>> different;
  for (const BriefTest& test : kBriefPattern) {
    squares_x += test.x1 * test.x1 + test.x2 * test.x2;
    squares_y += test.y1 * test.y1 + test.y2 * test.y2;
    different.insert({test.x1, test.y1, test.x2, test.y2});
  }
  EXPECT_NEAR(std::sqrt(squares_x / 512.0), 9.6, 0.7);
  EXPECT_NEAR(std::sqrt(squares_y / 512.0), 9.6, 0.7);
  EXPECT_EQ(different.size(), 256U);
}

Descriptor describe(const cv::Mat& image, const Pixel& centre) {
  IntegralImage integral;
  integral.compute(image);
  BriefDescriptor brief;
  brief.prepare(integral);
  return brief.describe(centre);
}

double boxMean(const cv::Mat& image, int x, int y) {
  return cv::mean(image(cv::Rect(x - 4, y - 4, 9, 9)))[0];
}

TEST(BriefDescriptor, comparesBoxMeans) {
  const cv::Mat image = noise(70, 60, 3, 128.0, 50.0);
  for (const Pixel centre : {Pixel{28, 28}, Pixel{35, 30}, Pixel{42, 32}}) {
    const Descriptor descriptor = describe(image, centre);
    for (std::size_t i = 0; i < Descriptor::kBits; ++i) {
      const BriefTest& test = kBriefPattern[i];
      const bool darker = boxMean(image, centre.x + test.x1, centre.y + test.y1) <
                          boxMean(image, centre.x + test.x2, centre.y + test.y2);
      ASSERT_EQ((descriptor.words[i / 64] >> (i % 64) & 1U) == 1U, darker) << "bit " << i;
    }
  }
}

TEST(BriefDescriptor, marginIsThePatchAndItsSmoothing) {
  const PatchMargin& margin = BriefDescriptor::kMargin;
  EXPECT_TRUE(margin.fits({28, 28}, 56, 56));
  EXPECT_FALSE(margin.fits({27, 28}, 56, 56));
  EXPECT_FALSE(margin.fits({28, 29}, 56, 56));
  EXPECT_FALSE(margin.fits({28, 28}, 55, 56));
}

TEST(BriefDescriptor, movesWithTheImage) {
  const cv::Mat image = texture(200, 150, 4);
  for (const cv::Point shift : {cv::Point(1, 0), cv::Point(13, 7), cv::Point(40, 30)}) {
    const cv::Mat shifted = image(cv::Rect(shift.x, shift.y, 120, 100));
    EXPECT_EQ(describe(image, {60 + shift.x, 50 + shift.y}), describe(shifted, {60, 50}));
  }
}

TEST(BriefDescriptor, isUnchangedByBrightnessAndContrast) {
  const cv::Mat image = texture(100, 100, 5, 12.0);
  const Descriptor original = describe(image, {50, 50});
  cv::Mat brighter;
  image.convertTo(brighter, -1, 1.0, 25.0);
  EXPECT_EQ(describe(brighter, {50, 50}), original);
  cv::Mat flatter;
  image.convertTo(flatter, -1, 0.5, 10.0);
  EXPECT_LE(hammingDistance(describe(flatter, {50, 50}), original), 4) << "rounding to grey levels only";
}

TEST(BriefDescriptor, differsBetweenPlaces) {
  const cv::Mat image = texture(300, 300, 6);
  EXPECT_GT(hammingDistance(describe(image, {60, 60}), describe(image, {220, 230})), 70);
}

TEST(BriefDescriptor, followsTheImageSize) {
  IntegralImage integral;
  BriefDescriptor used;
  for (const cv::Size size : {cv::Size(150, 90), cv::Size(90, 150), cv::Size(3, 3), cv::Size(60, 60)}) {
    const cv::Mat image = texture(size.width, size.height, 7);
    integral.compute(image);
    used.prepare(integral);
    if (BriefDescriptor::kMargin.fits({30, 30}, size.width, size.height)) {
      EXPECT_EQ(used.describe({30, 30}), describe(image, {30, 30})) << size;
    }
  }
}

}  // namespace
}  // namespace perennial
