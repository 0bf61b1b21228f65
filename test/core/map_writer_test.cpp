#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "map_test_support.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

/// Acts as a user without rights while it lives: root may write everywhere, and tests often run as root.
class WithoutRights {
 public:
  WithoutRights() : user_(::geteuid()) {
    if (user_ == 0 && ::seteuid(65534) != 0) {
      throw std::runtime_error("root cannot become nobody");
    }
  }
  ~WithoutRights() {
    if (user_ == 0 && ::seteuid(0) != 0) {
      std::abort();
    }
  }

 private:
  const uid_t user_;
};

class MapWriterTest : public testing::Test {
 protected:
  void addSome(MapWriter& writer, std::uint32_t count = 3) {
    for (std::uint32_t i = 0; i < count; ++i) {
      writer.add(randomLocalMap(i, random_), randomImage(random_));
    }
  }

  TemporaryFolder folder_;
  const std::string file_ = folder_ / "maps/garden.perennial";
  const std::string partial_ = file_ + ".partial";
  std::mt19937_64 random_{7};
};

TEST_F(MapWriterTest, nothingHasTheNameBeforeItIsFinished) {
  MapWriter writer(file_, testMetadata(), false);
  addSome(writer);
  EXPECT_EQ(writer.size(), 3U);
  EXPECT_FALSE(fs::exists(file_));
  EXPECT_TRUE(fs::exists(partial_));
  writer.finish({}, 1.0);
  EXPECT_TRUE(fs::exists(file_));
  EXPECT_FALSE(fs::exists(partial_));
  EXPECT_EQ(MapFile(file_).size(), 3U);
}

TEST_F(MapWriterTest, anUnfinishedMapVanishes) {
  {
    MapWriter writer(file_, testMetadata(), false);
    addSome(writer);
  }
  EXPECT_TRUE(fs::is_empty(folder_ / "maps"));
}

TEST_F(MapWriterTest, keepsAnExistingMap) {
  const std::vector<LocalMap> old = writeMap(file_, 4);
  const std::string error = errorOf([&] { MapWriter(file_, testMetadata(), false); });
  EXPECT_NE(error.find(file_), std::string::npos) << error;
  EXPECT_NE(error.find("exists already"), std::string::npos) << error;
  EXPECT_TRUE(sameBits(MapFile(file_).read(2), old[2]));
}

TEST_F(MapWriterTest, keepsAMapThatAppearsWhileTeaching) {
  MapWriter writer(file_, testMetadata(), false);
  addSome(writer, 5);
  writeMap(folder_ / "other", 2);
  fs::rename(folder_ / "other", file_);
  const std::string error = errorOf([&] { writer.finish({}, 1.0); });
  EXPECT_NE(error.find("exists already"), std::string::npos) << error;
  EXPECT_NE(error.find(partial_), std::string::npos) << "where the new map is: " << error;
  EXPECT_EQ(MapFile(file_).size(), 2U);
  fs::remove(file_);
  writer.finish({}, 1.0);
  EXPECT_EQ(MapFile(file_).size(), 5U);
}

TEST_F(MapWriterTest, keepsACompleteMapThatCouldNotBeNamed) {
  {
    MapWriter writer(file_, testMetadata(), false);
    addSome(writer, 5);
    writeMap(folder_ / "other", 2);
    fs::rename(folder_ / "other", file_);
    EXPECT_THROW(writer.finish({}, 1.0), MapError);
  }
  EXPECT_EQ(MapFile(partial_).size(), 5U);
  fs::remove(file_);
  EXPECT_NE(errorOf([&] { MapWriter(file_, testMetadata(), false); }).find("move or remove it"),
            std::string::npos);
}

TEST_F(MapWriterTest, overwritesInOneStepWhenAsked) {
  const std::vector<LocalMap> old = writeMap(file_, 4);
  const MapFile reader(file_);
  MapWriter writer(file_, testMetadata(), true);
  addSome(writer, 6);
  EXPECT_EQ(MapFile(file_).size(), 4U);
  writer.finish({}, 2.0);
  EXPECT_EQ(MapFile(file_).size(), 6U);
  EXPECT_TRUE(sameBits(reader.read(1), old[1])) << "who has opened the old one goes on reading it";
}

TEST_F(MapWriterTest, doesNotReplaceAMapThatIsBeingUpdated) {
  writeMap(file_, 4);
  MapFile manager(file_);
  manager.beginTraversal("latest/1", 1.0);
  MapWriter writer(file_, testMetadata(), true);
  addSome(writer, 6);
  EXPECT_NE(errorOf([&] { writer.finish({}, 2.0); }).find("using it"), std::string::npos);
  EXPECT_EQ(MapFile(file_).size(), 4U);
  manager.discardTraversal();
  writer.finish({}, 2.0);
  EXPECT_EQ(MapFile(file_).size(), 6U);
}

TEST_F(MapWriterTest, aMapThatWasReplacedTakesNoMoreTraversals) {
  writeMap(file_, 4);
  MapFile stale(file_);
  const std::vector<LocalMap> fresh = writeMap(file_, 6, 2, true);
  const std::string error = errorOf([&] {
    stale.beginTraversal("latest/1", 1.0);
    stale.stage(stale.read(0));
    stale.commitTraversal(2.0);
  });
  EXPECT_NE(error.find("replaced or removed"), std::string::npos) << error;
  const MapFile map(file_);
  EXPECT_TRUE(map.verify().empty());
  EXPECT_TRUE(sameBits(map.read(5), fresh[5]));
}

TEST_F(MapWriterTest, overwritesADamagedMapWhenAsked) {
  writeMap(file_, 4);
  fs::resize_file(file_, 5000);
  writeMap(file_, 6, 2, true);
  EXPECT_EQ(MapFile(file_).size(), 6U);
}

TEST_F(MapWriterTest, takesNoJournalOfAnEarlierMapForItsOwn) {
  fs::create_directories(folder_ / "maps");
  std::ofstream(file_ + "-journal") << "of a map that was removed";
  writeMap(file_, 4);
  EXPECT_FALSE(fs::exists(file_ + "-journal"));
}

TEST_F(MapWriterTest, replacesWhatACrashLeftBehind) {
  fs::create_directories(folder_ / "maps");
  std::ofstream(partial_) << std::string(10000, 'x');
  writeMap(file_, 4);
  EXPECT_TRUE(MapFile(file_).verify().empty());
}

TEST_F(MapWriterTest, refusesASecondTeacherOfOneMap) {
  MapWriter first(file_, testMetadata(), false);
  EXPECT_NE(errorOf([&] { MapWriter(file_, testMetadata(), false); }).find("another program"),
            std::string::npos);
  addSome(first);
  first.finish({}, 1.0);
  EXPECT_EQ(MapFile(file_).size(), 3U);
}

TEST_F(MapWriterTest, refusesWhatIsNoMap) {
  MapWriter writer(file_, testMetadata(), false);
  EXPECT_NE(errorOf([&] { writer.finish({}, 1.0); }).find("no local maps"), std::string::npos);
  addSome(writer, 2);
  EXPECT_THROW(writer.add(randomLocalMap(3, random_), randomImage(random_)), MapError)
      << "an index is missing";
  LocalMap behind = randomLocalMap(2, random_);
  behind.distance_m = 0.1;
  EXPECT_THROW(writer.add(behind, randomImage(random_)), MapError);
  LocalMap broken = randomLocalMap(2, random_);
  broken.stamp_s = std::nan("");
  EXPECT_THROW(writer.add(broken, randomImage(random_)), MapError);
  EXPECT_THROW(writer.add(randomLocalMap(2, random_), randomImage(random_, 13, 8)), ImageError);
  EXPECT_THROW(writer.add(randomLocalMap(2, random_), cv::Mat()), ImageError);
  EXPECT_THROW(writer.add(randomLocalMap(2, random_), cv::Mat(8, 12, CV_8UC3)), ImageError);
  EXPECT_THROW(writer.finish({}, 0.1), MapError) << "shorter than the way to its last local map";
  EXPECT_THROW(writer.finish({}, std::nan("")), MapError);
  writer.finish({}, 1.0);
  EXPECT_THROW(writer.add(randomLocalMap(2, random_), randomImage(random_)), MapError) << "finished";
}

TEST_F(MapWriterTest, refusesUnusableMetadata) {
  const std::vector<std::function<void(MapMetadata&)>> mistakes = {
      [](MapMetadata& m) { m.name = ""; },
      [](MapMetadata& m) { m.image_width = 0; },
      [](MapMetadata& m) { m.image_height = -1; },
      [](MapMetadata& m) { m.image_encoding = ""; },
      [](MapMetadata& m) { m.extraction = ""; },
      [](MapMetadata& m) { m.map_interval_m = 0.0; },
      [](MapMetadata& m) { m.map_interval_m = std::nan(""); },
      [](MapMetadata& m) { m.taught_stamp_s = std::nan(""); },
  };
  for (std::size_t i = 0; i < mistakes.size(); ++i) {
    MapMetadata metadata = testMetadata();
    mistakes[i](metadata);
    EXPECT_THROW(MapWriter(file_, metadata, false), MapError) << "mistake " << i;
  }
}

TEST_F(MapWriterTest, namesAFolderThatCannotBeMade) {
  std::ofstream(folder_ / "maps") << "a file";
  const std::string error = errorOf([&] { MapWriter(file_, testMetadata(), false); });
  EXPECT_NE(error.find(folder_ / "maps"), std::string::npos) << error;
  EXPECT_NE(error.find("Choose another map folder"), std::string::npos) << error;
}

TEST_F(MapWriterTest, namesAFolderThatCannotBeWritten) {
  fs::create_directories(folder_ / "maps");
  fs::permissions(folder_ / "", fs::perms(0755));
  fs::permissions(folder_ / "maps", fs::perms(0555));
  const WithoutRights user;
  const std::string error = errorOf([&] { MapWriter(file_, testMetadata(), false); });
  EXPECT_NE(error.find(partial_), std::string::npos) << error;
  EXPECT_NE(error.find("Permission denied"), std::string::npos) << error;
  EXPECT_NE(error.find("Choose another map folder"), std::string::npos) << error;
}

TEST_F(MapWriterTest, aReadOnlyMapIsReadAndNotWritten) {
  writeMap(file_, 3);
  fs::permissions(folder_ / "", fs::perms(0755));
  fs::permissions(file_, fs::perms(0444));
  const WithoutRights user;
  MapFile map(file_);
  EXPECT_NO_THROW(map.read(1));
  EXPECT_NE(errorOf([&] { map.beginTraversal("x", 1.0); }).find("permissions"), std::string::npos);
}

}  // namespace
}  // namespace perennial
