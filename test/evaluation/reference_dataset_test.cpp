// Map folders of the reference system, made up: read, replayed, and refused where they are malformed.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/core/persistence.hpp>
#include <opencv2/imgproc.hpp>

#include "perennial/core/dataset.h"
#include "perennial/core/error.h"
#include "perennial/core/reference_map.h"
#include "perennial/evaluation/replay_input.h"
#include "perennial/strategies/static_map.h"
#include "perennial/testing/temporary_folder.h"

namespace perennial {
namespace {

/// A panorama of a place; images are windows of it.
cv::Mat panorama(int place) {
  cv::Mat noise(150, 400, CV_8UC1);
  cv::theRNG().state = 40U + static_cast<unsigned>(place);
  cv::randu(noise, 0, 256);
  cv::GaussianBlur(noise, noise, {0, 0}, 2.0);
  cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  return noise;
}

cv::Mat window(int place, int left_px) { return panorama(place)(cv::Rect(left_px, 0, 300, 150)).clone(); }

struct StoredMap {
  cv::Mat image;
  cv::Mat descriptors;
  std::vector<float> ratings;
  double time_s = 0.0;  // 0: none
};

void writeStoredMap(const std::string& file, const StoredMap& map) {
  cv::FileStorage storage(file, cv::FileStorage::WRITE);
  if (!map.image.empty()) {
    storage << "Image" << map.image;
  }
  std::vector<cv::KeyPoint> keypoints;
  for (int i = 0; i < map.descriptors.rows; ++i) {
    keypoints.emplace_back(10.5F + static_cast<float>(i), 20.0F, 9.0F, -1.0F, 0.25F, 1, -1);
  }
  storage << "Keypoints" << keypoints;
  storage << "Descriptors" << map.descriptors;
  if (!map.ratings.empty()) {
    storage << "Ratings" << map.ratings;
  }
  if (map.time_s > 0.0) {
    storage << "Time" << map.time_s;
  }
}

cv::Mat bytes(int rows, int cols) {
  cv::Mat result(rows, cols, CV_8UC1);
  for (int i = 0; i < rows * cols; ++i) {
    result.data[i] = static_cast<unsigned char>(37 * i % 251);
  }
  return result;
}

/// The message of the error that a call gives.
template <typename Call>
std::string errorOf(const Call& call) {
  try {
    call();
  } catch (const DatasetError& error) {
    return error.what();
  }
  return "no error";
}

class ReferenceMaps : public ::testing::Test {
 protected:
  std::string errorOfMap(const StoredMap& map) {
    writeStoredMap(folder_ / "m_000.000.yaml", map);
    return errorOf([&] { readReferenceMap(folder_ / "m_000.000.yaml"); });
  }

  void expectError(const std::string& message, const std::string& file, const std::string& what) {
    EXPECT_NE(message.find(file), std::string::npos) << message;
    EXPECT_NE(message.find(what), std::string::npos) << message;
  }

  test_tools::TemporaryFolder folder_;
};

TEST_F(ReferenceMaps, areListedByNameAndDistance) {
  for (const char* file :
       {"b_000.200.yaml", "b_000.000.yaml", "a_100.000.yaml", "a.yaml", "a_GT.txt", "a_b_001.000.yaml"}) {
    std::ofstream(folder_ / file) << "x";
  }
  const auto maps = listReferenceMaps(folder_.path());
  ASSERT_EQ(maps.size(), 4U);
  EXPECT_EQ(maps[0].name, "a");
  EXPECT_EQ(maps[0].distance_m, 100.0);
  EXPECT_EQ(maps[1].name, "a_b");
  EXPECT_EQ(maps[2].file, folder_ / "b_000.000.yaml");
}

TEST_F(ReferenceMaps, areReadWithFeatures) {
  for (const int type : {CV_8U, CV_32F}) {
    StoredMap stored{window(0, 0), bytes(7, 32), {1, 2, 3, 4, 5, 6, 7}, 1500000000.0};
    bytes(7, 32).convertTo(stored.descriptors, type);
    writeStoredMap(folder_ / "m_000.000.yaml", stored);
    const ReferenceLocalMap map = readReferenceMap(folder_ / "m_000.000.yaml");
    EXPECT_EQ(cv::norm(map.image, stored.image, cv::NORM_INF), 0.0);
    ASSERT_EQ(map.features.size(), 7U);
    EXPECT_EQ(map.features.keypoints[3].x, 13.5F);
    EXPECT_FLOAT_EQ(map.features.keypoints[3].scale, 1.2F);
    EXPECT_EQ(std::memcmp(map.features.descriptors[6].words.data(), bytes(7, 32).ptr(6), 32), 0);
    EXPECT_EQ(map.ratings.at(4), 5.0);
    EXPECT_EQ(map.stamp_s, 1500000000.0);
    EXPECT_EQ(readReferenceTime(folder_ / "m_000.000.yaml"), 1500000000.0);
  }
}

TEST_F(ReferenceMaps, shortDescriptorsKeepTheirDistances) {
  writeStoredMap(folder_ / "m_000.000.yaml", {{}, bytes(2, 16), {}, 0.0});
  const ReferenceLocalMap map = readReferenceMap(folder_ / "m_000.000.yaml");
  EXPECT_TRUE(map.image.empty());
  EXPECT_FALSE(map.stamp_s);
  EXPECT_EQ(hammingDistance(map.features.descriptors[0], map.features.descriptors[1]),
            static_cast<int>(cv::norm(bytes(2, 16).row(0), bytes(2, 16).row(1), cv::NORM_HAMMING)));
}

TEST_F(ReferenceMaps, malformedOnesAreRefusedByName) {
  const std::string file = "m_000.000.yaml";
  cv::Mat fraction(3, 32, CV_32F, cv::Scalar(0.5));
  expectError(errorOfMap({window(0, 0), fraction, {}, 0.0}), file, "no bytes");
  expectError(errorOfMap({window(0, 0), cv::Mat(3, 32, CV_32F, cv::Scalar(256)), {}, 0.0}), file, "no bytes");
  expectError(errorOfMap({window(0, 0), cv::Mat(3, 64, CV_32F, cv::Scalar(1)), {}, 0.0}), file, "64 numbers");
  expectError(errorOfMap({window(0, 0), bytes(3, 32), {1, 2}, 0.0}), file, "2 Ratings");
  expectError(errorOfMap({cv::Mat(5, 5, CV_32F, cv::Scalar(1)), bytes(3, 32), {}, 0.0}), file, "8-bit");
  expectError(errorOfMap({{}, {}, {}, 0.0}), file, "neither");
  {
    cv::FileStorage storage(folder_ / file, cv::FileStorage::WRITE);
    storage << "Image" << window(0, 0) << "Descriptors" << bytes(3, 32);
  }
  expectError(errorOf([&] { readReferenceMap(folder_ / file); }), file, "0 Keypoints");
  std::ofstream(folder_ / file) << "PNG";
  expectError(errorOf([&] { readReferenceMap(folder_ / file); }), file + ":1:", "%YAML");
  std::ofstream(folder_ / file) << "%YAML:1.0\n---\nImage: !!opencv-matrix\n   rows: [";
  expectError(errorOf([&] { readReferenceMap(folder_ / file); }), file, "is no OpenCV FileStorage YAML");
  for (const char* size :
       {"rows: 1\n   cols: 100000", "rows: -1\n   cols: 2", "rows: 1\n   cols: \"many\"", "cols: 1"}) {
    std::ofstream(folder_ / file) << "%YAML:1.0\n---\nImage: !!opencv-matrix\n   " << size
                                  << "\n   dt: u\n   data: [ 1, 2 ]\n";
    expectError(errorOf([&] { readReferenceMap(folder_ / file); }), file, "is no matrix");
  }
  std::ofstream(folder_ / file) << "%YAML:1.0\n---\nTime: soon\n";
  expectError(errorOf([&] { readReferenceTime(folder_ / file); }), file + ":3:", "soon");
  expectError(errorOf([&] { readReferenceMap(folder_ / "none.yaml"); }), "none.yaml", "cannot be read");
}

/// Found by fuzz_reference_map.
TEST_F(ReferenceMaps, whatOpenCvWouldReadForEverIsRefused) {
  for (const std::string text : {" ta: b]\nTi\n--c-\n . ", "Image: 1\n--c-\n", " Image: 1\n", "...-\n...e",
                                 "Image: 1\n...\n---\nImage: 2\n"}) {
    try {
      decodeReferenceMap("%YAML:1.0\n---\n" + text, "spring_000.000.yaml");
      FAIL() << text;
    } catch (const DatasetError& error) {
      EXPECT_NE(std::string(error.what()).find("spring_000.000.yaml:"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("a name begins the line"), std::string::npos) << error.what();
    }
  }
}

TEST_F(ReferenceMaps, profilesAreReadAndChecked) {
  const std::string file = folder_ / "m.yaml";
  const auto write = [&](const std::vector<float>& path) {
    cv::FileStorage storage(file, cv::FileStorage::WRITE);
    storage << "Path" << path;
  };
  write({0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.3F, 0.0F, 0.0F, 1.5F, 0.3F, -0.2F, 0.1F});
  const PathProfile profile = readReferenceProfile(file);
  ASSERT_EQ(profile.entries().size(), 2U) << "of two entries at one distance the last one holds";
  EXPECT_NEAR(profile.at(1.0).forward, 0.3, 1e-6);
  EXPECT_NEAR(profile.at(1.6).angular, -0.2, 1e-6);
  EXPECT_NEAR(profile.at(1.6).flipper, 0.1, 1e-6);
  write({0.0F, 0.3F, 0.0F});
  expectError(errorOf([&] { readReferenceProfile(file); }), "m.yaml", "3 numbers");
  write({1.0F, 0.3F, 0.0F, 0.0F, 0.5F, 0.2F, 0.0F, 0.0F});
  expectError(errorOf([&] { readReferenceProfile(file); }), "m.yaml", "Path");
}

/// Three traversals of two places, a fortnight apart.
class ReferenceDataset : public ReferenceMaps {
 protected:
  static constexpr int kLeft_px[3][2] = {{40, 50}, {55, 30}, {70, 44}};

  void SetUp() override {
    const char* names[] = {"C", "A", "B"};  // not in order of time
    for (int t = 0; t < 3; ++t) {
      std::ofstream truth(folder_ / (std::string(names[t]) + "_GT.txt"));
      for (int place = 0; place < 2; ++place) {
        writeStoredMap(fileOf(names[t], place),
                       {window(place, kLeft_px[t][place]), bytes(3, 32), {}, 1.5e9 + 1.2e6 * t});
        truth << kLeft_px[t][place] << " 7\n";
      }
    }
  }

  std::string fileOf(const std::string& name, int place) const {
    return folder_ / (name + (place == 0 ? "_000.000.yaml" : "_001.000.yaml"));
  }
  std::string loadingError() const {
    return errorOf([&] { loadDataset(folder_.path()); });
  }
  ReplayInput load(bool stored) {
    const Dataset dataset = loadDataset(folder_.path());
    problems_.clear();
    return loadReplayInput(dataset, selectPlaces(dataset, {}, problems_), {{}, stored},
                           FeatureCache(folder_ / "cache"), 1, problems_, [](std::size_t) {});
  }

  std::vector<std::string> problems_;
};

TEST_F(ReferenceDataset, isReplayedWithTheSignOfTheGroundTruth) {
  const ReplayInput input = load(false);
  EXPECT_TRUE(problems_.empty());
  ASSERT_EQ(input.places.size(), 2U);
  for (std::size_t p = 0; p < 2; ++p) {
    const PlaceReplayResult result =
        replayPlace(input.places[p], strategies::StaticMap(), RegistrationSettings(), {});
    ASSERT_EQ(result.steps.size(), 2U);
    for (std::size_t v = 0; v < 2; ++v) {
      EXPECT_EQ(input.groundTruth(p, v), kLeft_px[v + 1][p] - kLeft_px[0][p])
          << "offset of the view less that of the map";
      ASSERT_TRUE(result.steps[v].displacement_px);
      EXPECT_NEAR(*result.steps[v].displacement_px, input.groundTruth(p, v), 1.0);
    }
  }
}

TEST_F(ReferenceDataset, isBroughtIntoOrderOfTime) {
  EXPECT_EQ(loadDataset(folder_.path()).traversals(), (std::vector<std::string>{"0_C", "1_A", "2_B"}));
  for (const char* name : {"A", "B", "C"}) {
    for (int place = 0; place < 2; ++place) {
      writeStoredMap(fileOf(name, place), {window(place, 0), {}, {}, 0.0});
    }
  }
  const Dataset without_times = loadDataset(folder_.path());
  EXPECT_EQ(without_times.traversals(), (std::vector<std::string>{"A", "B", "C"}));
  EXPECT_EQ(without_times.rows[2].stamp_s - without_times.rows[0].stamp_s, 86400.0);
}

TEST_F(ReferenceDataset, givesStoredFeaturesOnDemand) {
  const ReplayInput input = load(true);
  EXPECT_TRUE(problems_.empty());
  EXPECT_EQ(input.places.at(0).taught.features->size(), 3U);
  writeStoredMap(fileOf("A", 1), {{}, bytes(4, 32), {}, 1.5e9 + 1.2e6});
  load(false);
  ASSERT_EQ(problems_.size(), 1U);
  expectError(problems_[0], "A_001.000.yaml: ", "no Image");
}

TEST_F(ReferenceDataset, malformedOnesAreRefusedByFileAndLine) {
  std::ofstream(folder_ / "A_GT.txt") << "55 7\n30\n";
  expectError(loadingError(), "A_GT.txt:2:", "two integers");
  std::ofstream(folder_ / "A_GT.txt") << "55 7\n";
  expectError(loadingError(), "A_GT.txt:1:", "2 local maps");
  std::filesystem::remove(folder_ / "A_GT.txt");
  expectError(loadingError(), "A_GT.txt", "cannot be read");
  std::ofstream(folder_ / "A_GT.txt") << "55 7\n30 7\n";
  std::filesystem::rename(fileOf("B", 1), folder_ / "B_000.400.yaml");
  expectError(loadingError(), "B_000.400.yaml", "nearer to another place");
  std::filesystem::remove(folder_ / "B_000.400.yaml");
  expectError(loadingError(), "B_000.000.yaml", "1 local maps");
  writeStoredMap(fileOf("B", 1), {window(0, 0), {}, {}, 0.0});
  expectError(loadingError(), "B_001.000.yaml", "Time");
  writeStoredMap(fileOf("B", 1), {window(0, 0), {}, {}, 1.4e9});
  expectError(loadingError(), "B_001.000.yaml", "backwards");
}

}  // namespace
}  // namespace perennial
