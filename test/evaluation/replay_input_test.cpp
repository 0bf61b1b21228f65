#include "perennial/evaluation/replay_input.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "perennial/core/error.h"
#include "perennial/evaluation/parallel.h"
#include "perennial/testing/temporary_folder.h"

namespace perennial {
namespace {

/// A data set of two places of their own cameras, four traversals, on disk.
class ReplayInputTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream manifest(folder_ / "manifest.csv");
    manifest << "traversal,stamp,distance_m,image,offset_px\n";
    for (int traversal = 0; traversal < 4; ++traversal) {
      for (int place = 0; place < 2; ++place) {
        const std::string image = std::to_string(place) + std::to_string(traversal) + ".png";
        cv::imwrite(folder_ / image, picture(place, 10 * traversal, 160 + 20 * place));
        manifest << "t" << traversal << ",2020-01-0" << traversal + 1 << "T12:00:00Z," << place << ","
                 << image << "," << -10 * traversal << "\n";
      }
    }
  }

  static cv::Mat picture(int place, int left_px, int width) {
    cv::Mat noise(150, 300, CV_8UC1);
    cv::theRNG().state = 77U + static_cast<unsigned>(place);
    cv::randu(noise, 0, 256);
    cv::GaussianBlur(noise, noise, {0, 0}, 2.0);
    cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
    return noise(cv::Rect(left_px, 0, width, 150)).clone();
  }

  ReplayInput load(const ReplaySelection& selection = {},
                   const ExtractionSettings& extraction = ExtractionSettings::published()) {
    const Dataset dataset = loadDataset(folder_.path());
    problems_.clear();
    images_ = 0;
    return loadReplayInput(dataset, selectPlaces(dataset, selection, problems_), {extraction, false},
                           FeatureCache(folder_ / "cache"), 2, problems_,
                           [&](std::size_t done) { images_ = std::max(images_, done); });
  }

  bool hasProblem(const std::string& where, const std::string& what) const {
    return std::any_of(problems_.begin(), problems_.end(), [&](const std::string& problem) {
      return problem.find(where) != std::string::npos && problem.find(what) != std::string::npos;
    });
  }

  test_tools::TemporaryFolder folder_;
  std::vector<std::string> problems_;
  std::size_t images_ = 0;
};

TEST_F(ReplayInputTest, teachesFromTheFirstAndRegistersTheRest) {
  const ReplayInput input = load();
  EXPECT_TRUE(problems_.empty());
  EXPECT_EQ(images_, 8U);
  ASSERT_EQ(input.places.size(), 2U);
  ASSERT_EQ(input.places[1].views.size(), 3U);
  EXPECT_EQ(input.places[1].distance_m, 1.0);
  EXPECT_GT(input.places[1].taught.features->size(), 20U);
  EXPECT_EQ(input.rows[1][2].traversal, "t3");
  EXPECT_EQ(input.groundTruth(1, 2), 30.0);
}

TEST_F(ReplayInputTest, selectsTraversals) {
  const ReplayInput input = load({"t1", "t2", "t2"});
  ASSERT_EQ(input.places.size(), 2U);
  ASSERT_EQ(input.rows[0].size(), 1U);
  EXPECT_EQ(input.taught[0].traversal, "t1");
  EXPECT_EQ(input.rows[0][0].traversal, "t2");
  EXPECT_EQ(input.groundTruth(0, 0), 10.0);
  EXPECT_TRUE(load({"t9", "", ""}).places.empty());
  EXPECT_TRUE(hasProblem("manifest.csv:2:", "no map"));
}

TEST_F(ReplayInputTest, takesFeaturesFromTheCache) {
  const ReplayInput first = load();
  const ReplayInput second = load();
  EXPECT_EQ(first.ms_per_extraction, second.ms_per_extraction) << "measured when they were extracted";
  for (std::size_t p = 0; p < 2; ++p) {
    for (std::size_t v = 0; v < 3; ++v) {
      EXPECT_TRUE(*first.places[p].views[v].features == *second.places[p].views[v].features);
    }
  }
}

TEST_F(ReplayInputTest, takesEdgesFromTheCache) {
  const ReplayInput first = load({}, {});
  const ReplayInput second = load({}, {});
  EXPECT_EQ(first.ms_per_extraction, second.ms_per_extraction) << "measured when they were extracted";
  EXPECT_FALSE(first.places[0].views[0].features->edges.empty());
  EXPECT_EQ(first.places[0].views[0].features->edges, second.places[0].views[0].features->edges);
}

TEST_F(ReplayInputTest, aDamagedCacheIsNoCache) {
  const ReplayInput first = load();
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "cache")) {
    std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(200);
    file << "damage";
  }
  const ReplayInput second = load();
  EXPECT_TRUE(problems_.empty());
  EXPECT_TRUE(*first.places[0].views[0].features == *second.places[0].views[0].features);
}

TEST_F(ReplayInputTest, leavesOutWhatCannotBeUsedAndSaysWhere) {
  std::filesystem::remove(folder_ / "01.png");          // line 4
  std::ofstream(folder_ / "12.png") << "not an image";  // line 7
  cv::imwrite(folder_ / "13.png", picture(1, 0, 100));  // line 9
  const ReplayInput input = load();
  ASSERT_EQ(input.places.size(), 2U);
  EXPECT_EQ(input.places[0].views.size(), 2U);
  EXPECT_EQ(input.places[1].views.size(), 1U);
  EXPECT_EQ(problems_.size(), 3U);
  EXPECT_TRUE(hasProblem("manifest.csv:4:", "01.png"));
  EXPECT_TRUE(hasProblem("manifest.csv:7:", "not an image"));
  EXPECT_TRUE(hasProblem("manifest.csv:9:", "size"));
}

TEST_F(ReplayInputTest, aPlaceWithoutItsMapIsLeftOut) {
  std::filesystem::remove(folder_ / "00.png");
  const ReplayInput input = load();
  ASSERT_EQ(input.places.size(), 1U);
  EXPECT_EQ(input.places[0].distance_m, 1.0);
  EXPECT_TRUE(hasProblem("manifest.csv:2:", "left out"));
}

TEST_F(ReplayInputTest, repeatsViewsAsIfTheSameDaysCameAgain) {
  ReplayInput input = load();
  repeatViews(input, 8);
  ASSERT_EQ(input.places[1].views.size(), 8U);
  ASSERT_EQ(input.rows[1].size(), 8U);
  EXPECT_EQ(input.rows[1][2].traversal, "0000_t3");
  EXPECT_EQ(input.rows[1][7].traversal, "0002_t2");
  EXPECT_EQ(input.groundTruth(1, 7), 20.0);
  EXPECT_EQ(input.places[1].views[7].stamp_s, input.rows[1][1].stamp_s + 2 * 3 * 86400.0);
  EXPECT_EQ(input.rows[1][7].stamp_s, input.places[1].views[7].stamp_s);
  EXPECT_EQ(input.places[1].views[7].features, input.places[1].views[1].features);
  repeatViews(input, 3);
  EXPECT_EQ(input.places[0].views.size(), 8U) << "nothing is taken away";
}

TEST(ParallelFor, doesEachTaskOnceAndPassesErrorsOn) {
  std::vector<int> times(1000, 0);
  parallelFor(times.size(), 4, [&](std::size_t i) { ++times[i]; });
  EXPECT_EQ(times, std::vector<int>(1000, 1));
  parallelFor(0, 4, [](std::size_t) { FAIL(); });
  EXPECT_THROW(parallelFor(10, 3, [](std::size_t i) { i == 5 ? throw Error("five") : void(); }), Error);
}

}  // namespace
}  // namespace perennial
