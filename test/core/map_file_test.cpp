#include "perennial/core/map_file.h"

#include <gtest/gtest.h>

#include "map_test_support.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

class MapFileTest : public testing::Test {
 protected:
  TemporaryFolder folder_;
  const std::string file_ = folder_ / "garden.perennial";
};

TEST_F(MapFileTest, givesBackEveryBit) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const std::string file = folder_ / ("map" + std::to_string(seed));
    const std::vector<LocalMap> maps = writeMap(file, 7, seed);
    const MapFile map(file);
    ASSERT_EQ(map.size(), maps.size());
    for (const LocalMap& expected : maps) {
      EXPECT_TRUE(sameBits(map.read(expected.index), expected))
          << "seed " << seed << ", map " << expected.index;
    }
    EXPECT_TRUE(map.verify().empty());
  }
}

TEST_F(MapFileTest, givesBackImages) {
  std::mt19937_64 random(5);
  const cv::Mat image = randomImage(random);
  MapWriter writer(file_, testMetadata(), false);
  writer.add(randomLocalMap(0, random), image);
  writer.finish({}, 1.0);
  const cv::Mat stored = MapFile(file_).readImage(0);
  ASSERT_EQ(stored.size(), image.size());
  EXPECT_EQ(cv::norm(stored, image, cv::NORM_INF), 0.0);
}

TEST_F(MapFileTest, givesBackMetadataAndProfile) {
  writeMap(file_, 3);
  const MapFile map(file_);
  const MapMetadata expected = testMetadata();
  EXPECT_EQ(map.metadata().name, expected.name);
  EXPECT_EQ(map.metadata().camera, expected.camera);
  EXPECT_EQ(map.metadata().image_width, expected.image_width);
  EXPECT_EQ(map.metadata().image_height, expected.image_height);
  EXPECT_EQ(map.metadata().image_encoding, expected.image_encoding);
  EXPECT_EQ(map.metadata().extraction, expected.extraction);
  EXPECT_EQ(map.metadata().map_interval_m, expected.map_interval_m);
  EXPECT_EQ(map.metadata().taught_stamp_s, expected.taught_stamp_s);
  EXPECT_EQ(map.metadata().length_m, 0.2 * 3);
  EXPECT_TRUE(sameBits(map.profile().entries(), testProfile().entries()));
}

TEST_F(MapFileTest, keepsAProfileThatSettlesBackAtOneDistance) {
  PathProfile profile;
  profile.add(0.0, {1.0, 0.0, 0.0});
  profile.add(1.0, {0.0, 0.0, 0.0});
  profile.add(1.0, {1.0, 0.0, 0.0});
  std::mt19937_64 random(1);
  MapWriter writer(file_, testMetadata(), false);
  writer.add(randomLocalMap(0, random), randomImage(random));
  writer.finish(profile, 1.0);
  EXPECT_TRUE(sameBits(MapFile(file_).profile().entries(), profile.entries()));
}

TEST_F(MapFileTest, findsLocalMapsByDistance) {
  std::mt19937_64 random(1);
  MapWriter writer(file_, testMetadata(), false);
  const std::vector<double> distances = {0.0, 1.0, 1.0, 2.0, 4.0};
  for (std::uint32_t i = 0; i < distances.size(); ++i) {
    LocalMap map = randomLocalMap(i, random);
    map.distance_m = distances[i];
    writer.add(map, randomImage(random));
  }
  writer.finish({}, 4.0);
  const MapFile map(file_);
  EXPECT_EQ(map.nearest(-5.0).index, 0U);
  EXPECT_EQ(map.nearest(0.5).index, 0U) << "of two equally near the earlier";
  EXPECT_EQ(map.nearest(0.6).index, 1U) << "of two at one distance the earlier";
  EXPECT_EQ(map.nearest(1.4).index, 1U);
  EXPECT_EQ(map.nearest(3.0).index, 3U);
  EXPECT_EQ(map.nearest(1e300).index, 4U);
  EXPECT_EQ(map.nearest(std::numeric_limits<double>::infinity()).index, 4U);
  EXPECT_THROW(map.nearest(std::nan("")), MapError);
  const std::vector<LocalMapPlace> some = map.between(1.0, 2.0);
  ASSERT_EQ(some.size(), 3U);
  EXPECT_EQ(some[0].index, 1U);
  EXPECT_EQ(some[2].index, 3U);
  EXPECT_EQ(some[2].distance_m, 2.0);
  EXPECT_TRUE(map.between(2.5, 3.5).empty());
  EXPECT_TRUE(map.between(2.0, 1.0).empty());
}

TEST_F(MapFileTest, refusesLocalMapsThatDoNotExist) {
  writeMap(file_, 3);
  const MapFile map(file_);
  EXPECT_NE(errorOf([&] { map.read(3); }).find("no local map 3, only 0 to 2"), std::string::npos);
  EXPECT_THROW(map.readImage(3), MapError);
  EXPECT_NE(errorOf([&] { map.readAt(0, 1); }).find("no traversal 1, only 0 to 0"), std::string::npos);
}

TEST_F(MapFileTest, namesTheExtractionOfMapAndRobot) {
  EXPECT_NO_THROW(requireSameExtraction(testMetadata(), testMetadata().extraction));
  const std::string error =
      errorOf([] { requireSameExtraction(testMetadata(), "surf-brief/1 features=300"); });
  EXPECT_NE(error.find("features=300"), std::string::npos) << error;
  EXPECT_NE(error.find("features=500"), std::string::npos) << error;
  EXPECT_NE(error.find("teach the path again"), std::string::npos) << error;
}

class TraversalTest : public MapFileTest {
 protected:
  /// Another state of the local map: same place, other features.
  LocalMap changed(std::uint32_t index) {
    LocalMap map = randomLocalMap(index, random_);
    map.strategy = "latest/1";
    return map;
  }
  std::uint32_t traverse(MapFile& map, const std::vector<LocalMap>& states) {
    const std::uint32_t id = map.beginTraversal("latest/1", 100.0);
    for (const LocalMap& state : states) {
      map.stage(state);
    }
    map.commitTraversal(200.0);
    return id;
  }

  std::mt19937_64 random_{99};
  const std::vector<LocalMap> taught_ = writeMap(file_, 5);
};

TEST_F(TraversalTest, appearsAtCommitOnly) {
  MapFile map(file_);
  const MapFile reader(file_);
  const LocalMap state = changed(2);
  EXPECT_EQ(map.beginTraversal("latest/1", 100.0), 1U);
  map.stage(changed(2));
  map.stage(state);
  EXPECT_TRUE(sameBits(map.read(2), state)) << "the last one staged counts";
  EXPECT_TRUE(sameBits(reader.read(2), taught_[2]));
  EXPECT_EQ(reader.traversals().size(), 1U);
  map.commitTraversal(200.0);
  EXPECT_TRUE(sameBits(reader.read(2), state));
  EXPECT_TRUE(sameBits(reader.readAt(2, 0), taught_[2]));
  EXPECT_TRUE(sameBits(reader.read(3), taught_[3]));
  const std::vector<TraversalInfo> traversals = reader.traversals();
  ASSERT_EQ(traversals.size(), 2U);
  EXPECT_EQ(traversals[0].updated_maps, 5U);
  EXPECT_EQ(traversals[1].id, 1U);
  EXPECT_EQ(traversals[1].strategy, "latest/1");
  EXPECT_EQ(traversals[1].start_stamp_s, 100.0);
  EXPECT_EQ(traversals[1].end_stamp_s, 200.0);
  EXPECT_EQ(traversals[1].updated_maps, 1U);
  EXPECT_TRUE(map.verify().empty());
}

TEST_F(TraversalTest, leavesNothingWhenDiscarded) {
  MapFile map(file_);
  map.beginTraversal("latest/1", 100.0);
  map.stage(changed(0));
  map.discardTraversal();
  EXPECT_TRUE(sameBits(map.read(0), taught_[0]));
  EXPECT_EQ(map.traversals().size(), 1U);
  EXPECT_EQ(traverse(map, {changed(1)}), 1U);
}

TEST_F(TraversalTest, leavesNothingWhenItsProgramVanishes) {
  {
    MapFile map(file_);
    map.beginTraversal("latest/1", 100.0);
    map.stage(changed(0));
  }
  MapFile map(file_);
  EXPECT_TRUE(sameBits(map.read(0), taught_[0]));
  EXPECT_EQ(traverse(map, {changed(1)}), 1U);
}

TEST_F(TraversalTest, isNotRecordedWithoutChanges) {
  MapFile map(file_);
  traverse(map, {});
  EXPECT_EQ(map.traversals().size(), 1U);
  EXPECT_EQ(map.beginTraversal("latest/1", 100.0), 1U);
}

TEST_F(TraversalTest, keepsEveryState) {
  std::vector<std::vector<LocalMap>> history = {taught_};
  MapFile map(file_);
  for (std::uint32_t traversal = 1; traversal <= 30; ++traversal) {
    std::vector<LocalMap> states = history.back();
    std::vector<LocalMap> staged;
    for (LocalMap& state : states) {
      if (random_() % 3 == 0) {
        state = changed(state.index);
        staged.push_back(state);
      }
    }
    staged.push_back(states[0]);
    ASSERT_EQ(traverse(map, staged), traversal);
    history.push_back(states);
  }
  const MapFile reopened(file_);
  for (std::uint32_t traversal = 0; traversal < history.size(); ++traversal) {
    for (const LocalMap& expected : history[traversal]) {
      EXPECT_TRUE(sameBits(reopened.readAt(expected.index, traversal), expected))
          << "traversal " << traversal;
    }
  }
  EXPECT_TRUE(reopened.verify().empty());
}

TEST_F(TraversalTest, rollsBack) {
  MapFile map(file_);
  const LocalMap first = changed(1);
  traverse(map, {first});
  traverse(map, {changed(1), changed(2)});
  traverse(map, {changed(1)});
  EXPECT_THROW(map.rollback(4), MapError);
  map.rollback(3);
  EXPECT_EQ(map.traversals().size(), 4U);
  map.rollback(1);
  EXPECT_EQ(map.traversals().size(), 2U);
  EXPECT_TRUE(sameBits(map.read(1), first));
  EXPECT_TRUE(sameBits(map.read(2), taught_[2]));
  EXPECT_EQ(traverse(map, {changed(3)}), 2U) << "numbers are given anew";
  map.rollback(0);
  for (const LocalMap& expected : taught_) {
    EXPECT_TRUE(sameBits(map.read(expected.index), expected));
  }
  EXPECT_TRUE(map.verify().empty());
}

TEST_F(TraversalTest, refusesMisuse) {
  MapFile map(file_);
  EXPECT_THROW(map.stage(taught_[0]), MapError);
  EXPECT_THROW(map.commitTraversal(1.0), MapError);
  EXPECT_THROW(map.discardTraversal(), MapError);
  EXPECT_THROW(map.beginTraversal("x", std::nan("")), MapError);
  map.beginTraversal("latest/1", 100.0);
  EXPECT_THROW(map.beginTraversal("latest/1", 100.0), MapError);
  EXPECT_THROW(map.rollback(0), MapError);
  LocalMap moved = changed(2);
  moved.distance_m += 0.1;
  EXPECT_NE(errorOf([&] { map.stage(moved); }).find("local map 2"), std::string::npos);
  LocalMap broken = changed(2);
  broken.ids.push_back(0);
  EXPECT_THROW(map.stage(broken), MapError);
  LocalMap beyond = changed(2);
  beyond.index = 5;
  EXPECT_THROW(map.stage(beyond), MapError);
  map.discardTraversal();
}

TEST_F(TraversalTest, hasOneWriterAndManyReaders) {
  MapFile first(file_);
  MapFile second(file_);
  first.beginTraversal("latest/1", 100.0);
  const std::string error = errorOf([&] { second.beginTraversal("latest/1", 100.0); });
  EXPECT_NE(error.find(file_), std::string::npos) << error;
  EXPECT_NE(error.find("another program"), std::string::npos) << error;
  EXPECT_THROW(second.rollback(0), MapError);
  EXPECT_TRUE(sameBits(second.read(0), taught_[0]));
  EXPECT_TRUE(MapFile(file_).verify().empty()) << "opened and read while a traversal is open";
  first.stage(changed(0));
  first.commitTraversal(200.0);
  EXPECT_EQ(second.beginTraversal("latest/1", 300.0), 2U);
  second.discardTraversal();
}

TEST_F(TraversalTest, compactingMergesAllButTheNewest) {
  std::vector<LocalMap> states;
  {
    MapFile map(file_);
    for (const std::uint32_t index : {1U, 2U, 1U, 3U, 1U}) {
      states.push_back(changed(index));
      traverse(map, {states.back()});
    }
    map.compact(2);
    EXPECT_TRUE(map.verify().empty());
  }
  MapFile map(file_);
  const std::vector<TraversalInfo> traversals = map.traversals();
  ASSERT_EQ(traversals.size(), 4U) << "taught, merged, and the two newest";
  EXPECT_EQ(traversals[1].updated_maps, 2U) << "local maps 1 and 2, once each";
  EXPECT_TRUE(sameBits(map.readAt(1, 1), states[2])) << "the newest of those that were merged";
  EXPECT_TRUE(sameBits(map.readAt(2, 1), states[1]));
  EXPECT_TRUE(sameBits(map.readAt(3, 1), taught_[3]));
  EXPECT_TRUE(sameBits(map.readAt(3, 2), states[3]));
  EXPECT_TRUE(sameBits(map.read(1), states[4]));
  EXPECT_TRUE(sameBits(map.readAt(1, 0), taught_[1]));
  EXPECT_EQ(map.readImagePng(4).size(), MapFile(file_).readImagePng(4).size());
  EXPECT_TRUE(map.verify().empty());
  traverse(map, {changed(4)});
  EXPECT_EQ(map.traversals().back().id, 4U);
  map.rollback(1);
  EXPECT_TRUE(sameBits(map.read(1), states[2]));
}

TEST_F(TraversalTest, compactingKeepsWhatThereIsToKeep) {
  MapFile map(file_);
  const LocalMap state = changed(2);
  traverse(map, {state});
  map.compact(10);
  EXPECT_EQ(map.traversals().size(), 2U);
  EXPECT_EQ(map.traversals()[1].strategy, "latest/1");
  EXPECT_TRUE(sameBits(map.read(2), state));
  map.compact(0);
  EXPECT_EQ(map.traversals().size(), 2U) << "what was learned is never forgotten";
  EXPECT_TRUE(sameBits(map.read(2), state));
  EXPECT_TRUE(sameBits(map.readAt(2, 0), taught_[2]));
}

TEST_F(TraversalTest, isNotCompactedWhileSomebodyLearns) {
  MapFile map(file_);
  MapFile other(file_);
  other.beginTraversal("latest/1", 100.0);
  EXPECT_NE(errorOf([&] { map.compact(1); }).find("another program"), std::string::npos);
  EXPECT_THROW(other.compact(1), MapError);
  other.discardTraversal();
  map.compact(1);
  EXPECT_FALSE(fs::exists(file_ + ".partial"));
}

TEST_F(TraversalTest, oneFileIsAllThereIsAtRest) {
  MapFile map(file_);
  traverse(map, {changed(1)});
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(file_).parent_path())) {
    EXPECT_EQ(entry.path().string(), file_);
    ++files;
  }
  EXPECT_EQ(files, 1U);
}

}  // namespace
}  // namespace perennial
