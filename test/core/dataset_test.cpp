#include "perennial/core/dataset.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "perennial/core/csv.h"
#include "perennial/core/error.h"

namespace perennial {
namespace {

constexpr char kHeader[] = "traversal,stamp,distance_m,image,offset_px\n";

class DatasetTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::TempDir() + "dataset_XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& content) { std::ofstream(folder_ + "/manifest.csv") << content; }

  /// The message of the error that loading it gives.
  std::string errorOf(const std::string& content) {
    write(content);
    try {
      loadDataset(folder_);
    } catch (const DatasetError& error) {
      return error.what();
    }
    return "no error";
  }

  /// Checks that the error names the manifest, the line and the word.
  void expectError(const std::string& content, int line, const std::string& word) {
    const std::string message = errorOf(content);
    EXPECT_NE(message.find("manifest.csv:" + std::to_string(line) + ":"), std::string::npos) << message;
    EXPECT_NE(message.find(word), std::string::npos) << message;
  }

  std::string folder_;
};

TEST_F(DatasetTest, readsRowsInOrder) {
  write(std::string(kHeader) +
        "b,2012-02-15T12:00:00Z,1.0,b1.png,-3.5\n"
        "a,2012-01-15T12:00:01Z,1.0,sub/a1.png,7\n"
        "\n"
        "a,2012-01-15T12:00:00Z,0.0,a0.png,5\n");
  const Dataset dataset = loadDataset(folder_);
  ASSERT_EQ(dataset.rows.size(), 3U);
  EXPECT_EQ(dataset.traversals(), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(dataset.rows[0].image, folder_ + "/a0.png");
  EXPECT_EQ(dataset.rows[0].stamp_s, 1326628800.0);
  EXPECT_EQ(dataset.rows[0].line, 5U);
  const auto places = dataset.places();
  ASSERT_EQ(places.size(), 2U);
  ASSERT_EQ(places.at(1.0).size(), 2U);
  EXPECT_EQ(places.at(1.0)[0].traversal, "a");
  EXPECT_EQ(groundTruthDisplacement(places.at(1.0)[0], places.at(1.0)[1]), 10.5);
  EXPECT_EQ(dataset.traversal("b").size(), 1U);
}

TEST_F(DatasetTest, takesColumnsInAnyOrderCrLfQuotesAndAByteOrderMark) {
  write(
      "\xEF\xBB\xBFimage,comment,offset_px,stamp,distance_m,traversal\r\n"
      "\"a, the \"\"first\"\".png\",hm,1,2012-01-15T12:00:00Z,0,a\r\n");
  const Dataset dataset = loadDataset(folder_);
  ASSERT_EQ(dataset.rows.size(), 1U);
  EXPECT_EQ(dataset.rows[0].image, folder_ + "/a, the \"first\".png");
  EXPECT_EQ(csvField("a, the \"first\".png"), "\"a, the \"\"first\"\".png\"");
}

TEST_F(DatasetTest, errorsNameFileAndLine) {
  const std::string good = std::string(kHeader) + "a,2012-01-15T12:00:00Z,0,a0.png,5\n";
  expectError("traversal,stamp,distance_m,image\na,2012-01-15T12:00:00Z,0,a0.png\n", 1, "offset_px");
  expectError("traversal,traversal\n", 1, "twice");
  expectError(good + "b,2012-01-15T12:00:00Z,0,a0.png\n", 3, "4 fields");
  expectError(good + "b,2012-01-15,0,a0.png,5\n", 3, "2012-01-15");
  expectError(good + "b,2012-01-15T12:00:00Z,near,a0.png,5\n", 3, "distance_m");
  expectError(good + "b,2012-01-15T12:00:00Z,-1,a0.png,5\n", 3, "negative");
  expectError(good + "b,2012-01-15T12:00:00Z,1e7,a0.png,5\n", 3, "more than 1000 km");
  expectError(good + "b,2012-01-15T12:00:00Z,0,a0.png,nan\n", 3, "offset_px");
  expectError(good + "b,2012-01-15T12:00:00Z,0,,5\n", 3, "image");
  expectError(good + ",2012-01-15T12:00:00Z,0,a0.png,5\n", 3, "name");
  expectError(good + "a,2012-01-15T12:00:00Z,0.0,other.png,5\n", 3, "already (line 2)");
  expectError(good + "b,2011-01-15T12:00:00Z,0,a0.png,5\n", 3, "backwards");
  expectError(good + "\"b,2012-01-15T12:00:00Z,0,a0.png,5\n", 3, "quote");
  EXPECT_NE(errorOf("").find("manifest.csv"), std::string::npos);
  EXPECT_NE(errorOf(kHeader).find("no rows"), std::string::npos);
}

TEST_F(DatasetTest, timeOrderBelongsToAPlace) {
  write(std::string(kHeader) +
        "000,2013-05-02T07:15:00Z,0.0,a.png,0\n"
        "000,2012-05-02T07:15:00Z,1.0,b.png,0\n"
        "001,2012-06-02T07:15:00Z,1.0,c.png,0\n");
  EXPECT_NO_THROW(loadDataset(folder_));
}

TEST_F(DatasetTest, namesWhatIsMissing) {
  try {
    loadDataset(folder_ + "/nowhere");
    FAIL() << "no error";
  } catch (const DatasetError& error) {
    EXPECT_NE(std::string(error.what()).find("nowhere/manifest.csv"), std::string::npos) << error.what();
  }
  write(std::string(kHeader) + "a,2012-01-15T12:00:00Z,0,a0.png,5\n");
  const Dataset dataset = loadDataset(folder_);
  try {
    dataset.traversal("z");
    FAIL() << "no error";
  } catch (const DatasetError& error) {
    EXPECT_NE(std::string(error.what()).find("only: a"), std::string::npos) << error.what();
  }
  try {
    dataset.readImage(dataset.rows[0]);
    FAIL() << "no error";
  } catch (const DatasetError& error) {
    EXPECT_NE(std::string(error.what()).find("manifest.csv:2:"), std::string::npos) << error.what();
  }
}

TEST_F(DatasetTest, readsImagesAsGrey) {
  cv::imwrite(folder_ + "/a0.png", cv::Mat(20, 30, CV_8UC3, cv::Scalar(10, 10, 10)));
  write(std::string(kHeader) + "a,2012-01-15T12:00:00Z,0,a0.png,5\n");
  const Dataset dataset = loadDataset(folder_);
  const cv::Mat image = dataset.readImage(dataset.rows[0]);
  EXPECT_EQ(image.type(), CV_8UC1);
  EXPECT_EQ(image.size(), cv::Size(30, 20));
  EXPECT_EQ(image.at<std::uint8_t>(5, 5), 10);
}

}  // namespace
}  // namespace perennial
