// Disk full and power loss at every single step of writing a map.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "faulty_vfs.h"
#include "map_test_support.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

class MapFaultTest : public testing::Test {
 protected:
  MapFaultTest() {
    disk_.reset();
    taught_ = writeMap(pristine_, 6);
    std::mt19937_64 random(3);
    MapFile map(pristine_);
    map.beginTraversal("latest/1", 1.0);
    before_ = taught_;
    for (std::uint32_t i : {1U, 2U}) {
      before_[i] = randomLocalMap(i, random);
      map.stage(before_[i]);
    }
    map.commitTraversal(2.0);
    after_ = before_;
    for (LocalMap& state : after_) {
      state = randomLocalMap(state.index, random, 400);  // large enough to fill pages of their own
    }
  }
  ~MapFaultTest() override { disk_.reset(); }

  void copyPristine() {
    fs::copy_file(pristine_, file_, fs::copy_options::overwrite_existing);
    fs::remove(file_ + "-journal");
  }

  void stageAll(MapFile& map) {
    map.beginTraversal("latest/1", 3.0);
    for (const LocalMap& state : after_) {
      map.stage(state);
    }
  }

  /// 1: without the traversal, 2: with the whole of it, 0: anything else.
  int contentOf(const MapFile& map) {
    const std::size_t traversals = map.traversals().size();
    const std::vector<LocalMap>& expected = traversals == 2 ? before_ : after_;
    for (const LocalMap& state : expected) {
      if (!sameBits(map.read(state.index), state) ||
          !sameBits(map.readAt(state.index, 0), taught_[state.index])) {
        return 0;
      }
    }
    const bool sound = map.verify().empty() && (traversals == 2 || traversals == 3);
    return sound ? static_cast<int>(traversals) - 1 : 0;
  }

  FaultyDisk& disk_ = FaultyDisk::instance();
  TemporaryFolder folder_;
  const std::string pristine_ = folder_ / "pristine.perennial";
  const std::string file_ = folder_ / "garden.perennial";
  std::vector<LocalMap> taught_;
  std::vector<LocalMap> before_;
  std::vector<LocalMap> after_;
};

TEST_F(MapFaultTest, aFullDiskHarmsNothingAndTheCommitCanBeTriedAgain) {
  std::size_t failures = 0;
  for (std::size_t event = 1;; ++event) {
    copyPristine();
    MapFile map(file_);
    stageAll(map);
    disk_.failFrom(event, SQLITE_FULL);
    const std::string error = errorOf([&] { map.commitTraversal(4.0); });
    disk_.reset();
    if (error.empty()) {
      EXPECT_EQ(contentOf(MapFile(file_)), 2);
      break;
    }
    ++failures;
    EXPECT_NE(error.find(file_), std::string::npos) << error;
    EXPECT_NE(error.find("free some space"), std::string::npos) << error;
    EXPECT_EQ(contentOf(MapFile(file_)), 1) << "event " << event;
    map.commitTraversal(4.0);
    EXPECT_EQ(contentOf(map), 2) << "event " << event;
  }
  EXPECT_GT(failures, 20U);
}

TEST_F(MapFaultTest, powerLossLeavesATraversalWholeOrNotAtAll) {
  std::size_t kept = 0;
  std::size_t lost = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    for (std::size_t event = 1;; ++event) {
      copyPristine();
      disk_.reset();
      bool committed = false;
      {
        MapFile map(file_);
        stageAll(map);
        disk_.losePowerAt(event, seed * 1000 + event);
        committed = errorOf([&] { map.commitTraversal(4.0); }).empty();
      }
      const bool power_was_lost = disk_.powerIsLost();
      disk_.reset();
      const int content = contentOf(MapFile(file_));
      ASSERT_NE(content, 0) << "seed " << seed << ", event " << event;
      EXPECT_TRUE(!committed || content == 2) << "a commit that succeeded was lost";
      (content == 2 ? kept : lost) += 1;
      if (!power_was_lost) {
        break;
      }
    }
  }
  EXPECT_GT(lost, 100U);
  EXPECT_EQ(kept, 5U) << "nothing but the runs without power loss keeps the traversal";
}

TEST_F(MapFaultTest, powerLossWhileRollingBackLeavesOneStateOrTheOther) {
  for (std::size_t event = 1;; ++event) {
    copyPristine();
    disk_.reset();
    {
      MapFile map(file_);
      disk_.losePowerAt(event, event);
      errorOf([&] { map.rollback(0); });
    }
    const bool power_was_lost = disk_.powerIsLost();
    disk_.reset();
    const MapFile map(file_);
    EXPECT_TRUE(map.verify().empty()) << "event " << event;
    const bool undone = map.traversals().size() == 1;
    EXPECT_TRUE(sameBits(map.read(1), undone ? taught_[1] : before_[1])) << "event " << event;
    if (!power_was_lost) {
      EXPECT_TRUE(undone);
      break;
    }
  }
}

TEST_F(MapFaultTest, aFullDiskWhileTeachingLeavesTheOldMap) {
  std::size_t failures = 0;
  for (std::size_t event = 1;; event += 3) {
    copyPristine();
    disk_.failFrom(event, SQLITE_FULL);
    const std::string error = errorOf([&] { writeMap(file_, 300, 8, true); });
    disk_.reset();
    EXPECT_FALSE(fs::exists(file_ + ".partial"));
    if (error.empty()) {
      EXPECT_EQ(MapFile(file_).size(), 300U);
      break;
    }
    ++failures;
    EXPECT_NE(error.find("free some space"), std::string::npos) << error;
    EXPECT_EQ(contentOf(MapFile(file_)), 1) << "event " << event;
  }
  EXPECT_GT(failures, 10U);
}

TEST_F(MapFaultTest, aWriterThatFailedOnceGivesNoMap) {
  std::mt19937_64 random(1);
  MapWriter writer(folder_ / "other.perennial", testMetadata(), false);
  disk_.failFrom(1, SQLITE_FULL);
  std::string error;
  for (std::uint32_t i = 0; error.empty() && i < 5000; ++i) {
    error = errorOf([&] { writer.add(randomLocalMap(i, random, 400), randomImage(random)); });
  }
  disk_.reset();
  ASSERT_NE(error, "");
  EXPECT_NE(errorOf([&] { writer.finish({}, 1e6); }).find("failed before"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "other.perennial"));
}

TEST_F(MapFaultTest, openingAndReadingTouchesAsLittleOfALongPath) {
  const std::string path = folder_ / "long.perennial";
  std::mt19937_64 random(1);
  constexpr std::uint32_t kLocalMaps = 50000;  // 10 km
  sqlite3_memory_highwater(1);
  {
    MapWriter writer(path, testMetadata(), false);
    const cv::Mat image = randomImage(random);
    for (std::uint32_t i = 0; i < kLocalMaps; ++i) {
      writer.add(randomLocalMap(i, random, 3), image);
    }
    writer.finish(testProfile(), 0.2 * kLocalMaps);
  }
  EXPECT_LT(sqlite3_memory_highwater(1), 8 << 20) << "while teaching";
  disk_.reset();
  const MapFile map(path);
  EXPECT_LT(disk_.reads(), 40U) << "of some 9000 pages";
  ASSERT_EQ(map.size(), kLocalMaps);
  disk_.reset();
  EXPECT_EQ(map.nearest(7777.71).index, 38889U);
  map.read(38889);
  map.readImage(38889);
  EXPECT_EQ(map.between(7000.0, 7001.05).size(), 6U);
  EXPECT_LT(disk_.reads(), 60U);
  for (std::uint32_t i = 0; i < kLocalMaps; i += 7) {
    map.read(i);
  }
  EXPECT_LT(sqlite3_memory_highwater(1), 8 << 20) << "while reading";
}

TEST_F(MapFaultTest, stagingALongPathNeedsNoMemory) {
  const std::string path = folder_ / "long.perennial";
  std::mt19937_64 random(1);
  constexpr std::uint32_t kLocalMaps = 1000;
  {
    MapWriter writer(path, testMetadata(), false);
    const cv::Mat image = randomImage(random);
    for (std::uint32_t i = 0; i < kLocalMaps; ++i) {
      writer.add(randomLocalMap(i, random, 0), image);
    }
    writer.finish({}, 0.2 * kLocalMaps);
  }
  MapFile map(path);
  LocalMap state;
  for (int i = 0; i < 600; ++i) {
    state.add({}, {});
  }
  disk_.reset();
  sqlite3_memory_highwater(1);
  map.beginTraversal("latest/1", 1.0);
  for (std::uint32_t i = 0; i < kLocalMaps; ++i) {
    const LocalMap taught = map.read(i);
    state.index = i;
    state.distance_m = taught.distance_m;
    state.stamp_s = taught.stamp_s;
    map.stage(state);
  }
  EXPECT_EQ(disk_.events(), 0U) << "the map file is not touched before the commit";
  map.commitTraversal(2.0);
  EXPECT_GT(map.sizes().learned_bytes, 30000000U);
  EXPECT_LT(sqlite3_memory_highwater(1), 8 << 20);
}

}  // namespace
}  // namespace perennial
