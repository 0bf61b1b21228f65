#include "perennial/core/edge_field.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <numeric>

#include "core/features/edge_field_extractor.h"
#include "core/features/synthetic_images.h"
#include "perennial/core/feature_extractor.h"

namespace perennial {
namespace {

int valueAt(const EdgeField& field, int column, int row, bool sine) {
  return field.values[2 * static_cast<std::size_t>(row * field.columns + column) + (sine ? 1 : 0)];
}

TEST(EdgeField, cellsGrowWithTheImage) {
  struct Case {
    cv::Size size;
    int cell_px, columns, rows;
  };
  for (const Case& c :
       {Case{{752, 480}, 8, 94, 60}, Case{{1024, 384}, 8, 128, 48}, Case{{1032, 384}, 16, 64, 24},
        Case{{1920, 1080}, 16, 120, 67}, Case{{300, 1100}, 16, 18, 68}, Case{{23, 8}, 8, 2, 1}}) {
    const EdgeField field = edgeFieldOf(texture(c.size.width, c.size.height, 1));
    EXPECT_EQ(field.cell_px, c.cell_px) << c.size;
    EXPECT_EQ(field.columns, c.columns) << c.size;
    EXPECT_EQ(field.rows, c.rows) << c.size;
    EXPECT_TRUE(field.sound()) << c.size;
  }
}

TEST(EdgeField, isEmptyWhereThereIsNoCell) {
  for (const cv::Size size : {cv::Size(0, 0), cv::Size(7, 100), cv::Size(100, 7), cv::Size(1, 1)}) {
    const EdgeField field = edgeFieldOf(cv::Mat(size, CV_8UC1, cv::Scalar(9)));
    EXPECT_TRUE(field.empty()) << size;
    EXPECT_TRUE(field.sound()) << size;
  }
}

TEST(EdgeField, tellsHowEdgesRunNotWhichSideIsBright) {
  // Upright bars on the left, lying ones on the right: cosine positive and negative.
  cv::Mat image(160, 320, CV_8UC1, cv::Scalar(60));
  for (int i = 0; i < 160; i += 40) {
    image(cv::Rect(i, 0, 20, 160)).setTo(180);
    image(cv::Rect(160, i, 160, 20)).setTo(180);
  }
  const EdgeField field = edgeFieldOf(image);
  cv::Mat inverted;
  cv::subtract(cv::Scalar(240), image, inverted);
  const EdgeField other = edgeFieldOf(inverted);
  int upright = 0;
  int lying = 0;
  for (int row = 1; row < field.rows - 1; ++row) {
    for (int column = 0; column < field.columns; ++column) {
      (column < 20 ? upright : lying) += valueAt(field, column, row, false);
      EXPECT_NEAR(valueAt(field, column, row, false), valueAt(other, column, row, false), 2);
      EXPECT_NEAR(valueAt(field, column, row, true), valueAt(other, column, row, true), 2);
    }
  }
  const int cells = (field.rows - 2) * 20;
  EXPECT_GT(upright, 20 * cells);
  EXPECT_LT(lying, -20 * cells);
}

TEST(EdgeField, rowsHaveNoMean) {
  // Upright bars everywhere: nothing tells one place from another but where the bars are.
  const EdgeField field = edgeFieldOf(texture(640, 480, 3));
  for (int row = 0; row < field.rows; ++row) {
    for (const bool sine : {false, true}) {
      int sum = 0;
      for (int column = 0; column < field.columns; ++column) {
        sum += valueAt(field, column, row, sine);
      }
      EXPECT_LE(std::abs(sum), field.columns / 2) << "rounding only";
    }
  }
}

TEST(EdgeField, comesWithFeaturesOfOrientations) {
  const cv::Mat image = texture(320, 240, 4);
  for (const bool half : {false, true}) {
    ExtractionSettings settings;
    settings.half_resolution = half;
    EXPECT_EQ(FeatureExtractor(settings).extract(image).edges, edgeFieldOf(image));
    settings.descriptor = DescriptorKind::kIntensity;
    EXPECT_TRUE(FeatureExtractor(settings).extract(image).edges.empty());
  }
}

TEST(EdgeField, notesNumbersThatDoNotAgree) {
  const EdgeField good = edgeFieldOf(texture(320, 240, 5));
  ASSERT_TRUE(good.sound());
  EXPECT_TRUE(EdgeField{}.sound());
  EdgeField bad = good;
  ++bad.rows;
  EXPECT_FALSE(bad.sound());
  bad = good;
  bad.columns = -bad.columns;
  bad.rows = -bad.rows;
  EXPECT_FALSE(bad.sound());
  bad = good;
  bad.cell_px = 0;
  EXPECT_FALSE(bad.sound());
  bad = good;
  bad.values[7] = -128;
  EXPECT_FALSE(bad.sound());
}

}  // namespace
}  // namespace perennial
