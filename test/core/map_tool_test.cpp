// Runs the tool itself, as a user does; MAP_TOOL is its path.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <opencv2/core/persistence.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "format1_map.h"
#include "perennial/core/feature_extractor.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

struct Result {
  int status = -1;
  std::string output;  // and errors
};

Result run(const std::string& arguments) {
  Result result;
  FILE* pipe = popen((std::string(MAP_TOOL) + " " + arguments + " 2>&1").c_str(), "r");
  char buffer[4096];
  for (std::size_t count = 0; pipe != nullptr && (count = fread(buffer, 1, sizeof(buffer), pipe)) > 0;) {
    result.output.append(buffer, count);
  }
  result.status = WEXITSTATUS(pclose(pipe));
  return result;
}

std::vector<std::string> linesOf(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(line);
  }
  return lines;
}

class MapToolTest : public testing::Test {
 protected:
  MapToolTest() {
    taught_ = writeMap(file_, 4);
    std::mt19937_64 random(3);
    MapFile map(file_);
    map.beginTraversal("score_based/1", 1700100000.0);
    learned_ = randomLocalMap(2, random);
    map.stage(learned_);
    map.commitTraversal(1700100060.5);
  }

  TemporaryFolder folder_;
  const std::string file_ = folder_ / "garden.perennial";
  std::vector<LocalMap> taught_;
  LocalMap learned_;
};

TEST_F(MapToolTest, listsLocalMapsAndMaps) {
  const Result local_maps = run("list " + file_);
  EXPECT_EQ(local_maps.status, 0);
  EXPECT_EQ(std::count(local_maps.output.begin(), local_maps.output.end(), '\n'), 5) << local_maps.output;
  EXPECT_NE(local_maps.output.find("0.600  2023-11-14T22:13:20.300000Z"), std::string::npos)
      << local_maps.output;
  std::ofstream(folder_ / "broken.perennial") << "x";
  const Result maps = run("list " + folder_ / "");
  EXPECT_EQ(maps.status, 0);
  EXPECT_NE(maps.output.find("garden  0.8 m, 4 local maps, 1 traversals"), std::string::npos) << maps.output;
  EXPECT_NE(maps.output.find("broken  unusable: "), std::string::npos) << maps.output;
}

TEST_F(MapToolTest, printsInfo) {
  const Result info = run("info " + file_);
  EXPECT_EQ(info.status, 0);
  for (const char* part : {"garden", "format version  2\n", "12x8 px, mono8", "surf-brief/1 features=500",
                           "0.8 m", "3 entries", "1 beside the teaching", "2023-11-14T22:13:20.123457Z"}) {
    EXPECT_NE(info.output.find(part), std::string::npos) << part << " is not in " << info.output;
  }
}

TEST_F(MapToolTest, readsAMapOfFormat1AsItIsAndMigratesItWhenItIsToBeWritten) {
  const std::string file = folder_ / "old.perennial";
  fs::copy_file(FORMAT1_MAP, file);
  const std::vector<char> original = bytesOf(file);
  const Result info = run("info " + file);
  EXPECT_NE(info.output.find("format version  1\n"), std::string::npos) << info.output;
  EXPECT_NE(info.output.find(ExtractionSettings::published().describe()), std::string::npos) << info.output;
  for (const std::string& command : {"list " + file, "list " + folder_ / "", "verify " + file,
                                     "history " + file, "export " + file + " --out " + folder_ / "out"}) {
    const Result result = run(command);
    EXPECT_EQ(result.status, 0) << command << ": " << result.output;
    EXPECT_EQ(bytesOf(file), original) << command;
  }
  const Result rolled_back = run("rollback " + file + " --to 1");
  EXPECT_EQ(rolled_back.status, 0) << rolled_back.output;
  EXPECT_NE(
      rolled_back.output.find("migrated to format version 2; the original is kept as '" + file + ".format1'"),
      std::string::npos)
      << rolled_back.output;
  EXPECT_EQ(bytesOf(file + ".format1"), original);
  EXPECT_NE(run("info " + file).output.find("format version  2\n"), std::string::npos);
  EXPECT_EQ(run("list " + folder_ / "").output.find("format1"), std::string::npos);
}

TEST_F(MapToolTest, verifies) {
  EXPECT_EQ(run("verify " + file_).status, 0);
  std::fstream(file_, std::ios::in | std::ios::out | std::ios::binary).seekp(6 * 4096 + 100).put('\x55');
  const Result damaged = run("verify " + file_);
  EXPECT_EQ(damaged.status, 1);
  EXPECT_NE(damaged.output.find("page 7"), std::string::npos) << damaged.output;
  const Result missing = run("verify " + file_ + "x");
  EXPECT_EQ(missing.status, 1);
  EXPECT_NE(missing.output.find("does not exist"), std::string::npos) << missing.output;
}

TEST_F(MapToolTest, printsHistoryAndRollsBack) {
  const Result history = run("history " + file_);
  EXPECT_EQ(history.status, 0);
  EXPECT_NE(history.output.find("(taught)"), std::string::npos) << history.output;
  EXPECT_NE(history.output.find("score_based/1"), std::string::npos) << history.output;
  EXPECT_EQ(run("rollback " + file_).status, 2);
  EXPECT_EQ(run("rollback " + file_ + " --to x").status, 2);
  EXPECT_EQ(run("rollback " + file_ + " --to 2").status, 1);
  EXPECT_EQ(MapFile(file_).traversals().size(), 2U) << "nothing has happened so far";
  EXPECT_EQ(run("rollback --to 0 " + file_).status, 0);
  EXPECT_TRUE(sameBits(MapFile(file_).read(2), taught_[2]));
}

TEST_F(MapToolTest, compacts) {
  for (int i = 0; i < 3; ++i) {
    MapFile map(file_);
    map.beginTraversal("score_based/1", 1700200000.0 + i);
    map.stage(learned_);
    map.commitTraversal(1700200060.0 + i);
  }
  EXPECT_EQ(run("compact " + file_ + " --keep x").status, 2);
  EXPECT_EQ(run("compact " + file_).status, 0);
  EXPECT_EQ(MapFile(file_).traversals().size(), 5U) << "fewer than ten: all are kept";
  const Result compacted = run("compact " + file_ + " --keep 1");
  EXPECT_EQ(compacted.status, 0) << compacted.output;
  EXPECT_NE(compacted.output.find("2 traversals merged"), std::string::npos) << compacted.output;
  EXPECT_EQ(MapFile(file_).traversals().size(), 3U);
  EXPECT_TRUE(sameBits(MapFile(file_).read(2), learned_));
  EXPECT_EQ(run("verify " + file_).status, 0);
}

TEST_F(MapToolTest, exportsEveryBit) {
  const fs::path out(folder_ / "out");
  const Result exported = run("export " + file_ + " --out " + out.string());
  ASSERT_EQ(exported.status, 0) << exported.output;

  const cv::Mat image = cv::imread((out / "images/000002.png").string(), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(cv::norm(image, MapFile(file_).readImage(2), cv::NORM_INF), 0.0);

  const std::vector<std::string> features = linesOf(out / "features/000002.csv");
  ASSERT_EQ(features.size(), learned_.size() + 1);
  for (std::size_t i = 0; i < learned_.size(); ++i) {
    std::vector<std::string> cells;
    std::stringstream line(features[i + 1]);
    for (std::string cell; std::getline(line, cell, ',');) {
      cells.push_back(cell);
    }
    ASSERT_EQ(cells.size(), 6 + learned_.numbers_per_feature);
    EXPECT_EQ(cells[0], std::to_string(learned_.ids[i]));
    EXPECT_EQ(std::strtof(cells[1].c_str(), nullptr), learned_.features.keypoints[i].x);
    EXPECT_EQ(std::strtof(cells[4].c_str(), nullptr), learned_.features.keypoints[i].response);
    EXPECT_EQ(cells[5].size(), 64U);
    for (std::size_t k = 0; k < learned_.numbers_per_feature; ++k) {
      EXPECT_EQ(std::strtod(cells[6 + k].c_str(), nullptr), learned_.featureNumbers(i)[k]);
    }
  }

  const YAML::Node profile = YAML::LoadFile((out / "profile.yaml").string());
  ASSERT_EQ(profile.size(), 3U);
  EXPECT_EQ(profile[1]["distance_m"].as<double>(), 1.25);
  EXPECT_EQ(profile[1]["flipper"].as<double>(), -0.3);
  const YAML::Node metadata = YAML::LoadFile((out / "metadata.yaml").string());
  EXPECT_EQ(metadata["taught_stamp_s"].as<double>(), testMetadata().taught_stamp_s);
  EXPECT_EQ(metadata["name"].as<std::string>(), "garden");
  EXPECT_EQ(metadata["extraction"].as<std::string>(), testMetadata().extraction);
  ASSERT_EQ(metadata["traversals"].size(), 2U);
  EXPECT_EQ(metadata["traversals"][1]["updated_maps"].as<int>(), 1);
  EXPECT_EQ(linesOf(out / "local_maps.csv").size(), 5U);

  const Result again = run("export " + file_ + " --out " + out.string());
  EXPECT_EQ(again.status, 1);
  EXPECT_NE(again.output.find("not an empty folder"), std::string::npos) << again.output;
}

/// A map of the reference system: three local maps of noise, 0.5 m apart.
class MapImportTest : public testing::Test {
 protected:
  MapImportTest() {
    fs::create_directories(folder_ / "stored");
    for (int i = 0; i < 3; ++i) {
      cv::FileStorage storage(fileOf(i), cv::FileStorage::WRITE);
      storage << "Image" << picture(i, {200, 120}) << "Keypoints"
              << std::vector<cv::KeyPoint>(1, {9.F, 9.F, 9.F});
      storage << "Descriptors" << cv::Mat(1, 32, CV_32F, cv::Scalar(7)) << "Time" << 1500000000 + i;
    }
    cv::FileStorage profile(folder_ / "stored/way.yaml", cv::FileStorage::WRITE);
    profile << "Path"
            << std::vector<float>{0.0F, 0.5F, 0.0F, 0.0F, 0.6F, 0.5F, 0.1F, 0.0F, 1.2F, 0.0F, 0.0F, 0.0F};
  }

  std::string fileOf(int i) const {
    const char* const distances[] = {"000.000", "000.500", "001.000"};
    return folder_ / (std::string("stored/way_") + distances[i] + ".yaml");
  }

  static cv::Mat picture(int seed, cv::Size size) {
    cv::Mat image(size, CV_8UC1);
    cv::theRNG().state = 9U + static_cast<unsigned>(seed);
    cv::randu(image, 0, 256);
    return image;
  }

  Result import(const std::string& options = "") {
    return run("import " + folder_ / "stored" + " --out " + folder_ / "way.perennial" + " " + options);
  }
  /// Expects to be refused, with this said, and no file left.
  void expectRefused(const std::string& what) {
    const Result result = import();
    EXPECT_EQ(result.status, 1);
    EXPECT_NE(result.output.find(what), std::string::npos) << result.output;
    EXPECT_FALSE(fs::exists(folder_ / "way.perennial"));
  }

  TemporaryFolder folder_;
};

TEST_F(MapImportTest, makesAMapToDriveWith) {
  const Result result = import("--encoding rgb8");
  ASSERT_EQ(result.status, 0) << result.output;
  const MapFile map(folder_ / "way.perennial");
  EXPECT_TRUE(map.verify().empty());
  ASSERT_EQ(map.size(), 3U);
  EXPECT_EQ(map.metadata().name, "way");
  EXPECT_EQ(map.metadata().image_encoding, "rgb8");
  EXPECT_NEAR(map.metadata().length_m, 1.2, 1e-6) << "the end of the profile";
  EXPECT_EQ(map.metadata().map_interval_m, 0.5);
  EXPECT_EQ(map.metadata().taught_stamp_s, 1500000000.0);
  EXPECT_EQ(map.metadata().extraction, ExtractionSettings().describe())
      << "as the navigator extracts by default";
  EXPECT_EQ(map.profile().at(0.7).forward, 0.5);
  EXPECT_NEAR(map.profile().at(0.7).angular, 0.1, 1e-6);
  const LocalMap second = map.read(1);
  EXPECT_EQ(second.distance_m, 0.5);
  EXPECT_EQ(second.stamp_s, 1500000001.0);
  EXPECT_TRUE(second.features == FeatureExtractor().extract(picture(1, {200, 120})));
  EXPECT_EQ(cv::norm(map.readImage(1), picture(1, {200, 120}), cv::NORM_INF), 0.0);
  EXPECT_EQ(import().status, 1) << "a map that exists is not replaced";
}

TEST_F(MapImportTest, saysWhatItRefuses) {
  {
    cv::FileStorage storage(folder_ / "stored/other_000.000.yaml", cv::FileStorage::WRITE);
    storage << "Image" << picture(0, {200, 120});
  }
  expectRefused("several maps; say --name and one of: other, way");
  fs::remove(folder_ / "stored/other_000.000.yaml");
  {
    cv::FileStorage storage(fileOf(2), cv::FileStorage::WRITE);
    storage << "Image" << picture(2, {200, 100});
  }
  expectRefused("way_001.000.yaml: its Image differs in size");
  {
    cv::FileStorage storage(fileOf(2), cv::FileStorage::WRITE);
    storage << "Keypoints" << std::vector<cv::KeyPoint>(1, {9.F, 9.F, 9.F});
    storage << "Descriptors" << cv::Mat(1, 32, CV_32F, cv::Scalar(7));
  }
  expectRefused("way_001.000.yaml: holds no Image");
  {
    cv::FileStorage storage(fileOf(2), cv::FileStorage::WRITE);
    storage << "Image" << picture(2, {200, 120}) << "Keypoints"
            << std::vector<cv::KeyPoint>(1, {9.F, 9.F, 9.F});
    storage << "Descriptors" << cv::Mat(1, 32, CV_32F, cv::Scalar(0.5));
  }
  expectRefused("way_001.000.yaml: Descriptors hold numbers that are no bytes");
  fs::remove(folder_ / "stored/way.yaml");
  expectRefused("way.yaml: cannot be read");
}

TEST_F(MapToolTest, helpsAndRefusesWrongUse) {
  EXPECT_EQ(run("--help").status, 0);
  EXPECT_NE(run("--help").output.find("exit status"), std::string::npos);
  for (const char* arguments : {"", "list", "frobnicate x", "list a b", "list --out x a", "export a --out"}) {
    const Result wrong = run(arguments);
    EXPECT_EQ(wrong.status, 2) << arguments;
    EXPECT_NE(wrong.output.find("usage:"), std::string::npos) << wrong.output;
  }
}

}  // namespace
}  // namespace perennial
