// A map of format version 1 is read as it is, and migrated on a copy when something is to be written.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <functional>

#include "map_migration_fixture.h"
#include "perennial/core/feature_extractor.h"
#include "perennial/core/map_manager.h"
#include "perennial/core/map_name.h"
#include "perennial/strategies/latest_map.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

/// Another program's connection, through the layer of page checksums.
class OtherProgram {
 public:
  explicit OtherProgram(const std::string& file) {
    EXPECT_EQ(sqlite3_open_v2(file.c_str(), &database_, SQLITE_OPEN_READWRITE, "perennial-checksum"),
              SQLITE_OK);
  }
  ~OtherProgram() { sqlite3_close(database_); }
  OtherProgram(const OtherProgram&) = delete;
  OtherProgram& operator=(const OtherProgram&) = delete;

  void run(const char* sql) {
    EXPECT_EQ(sqlite3_exec(database_, sql, nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database_);
  }

 private:
  sqlite3* database_ = nullptr;
};

class MapMigrationTest : public MigrationFixture {
 protected:
  MapMigrationTest() { copyPristine(); }
};

TEST_F(MapMigrationTest, readingChangesNoByte) {
  {
    const MapFile map(file_);
    EXPECT_EQ(map.formatVersion(), 1U);
    EXPECT_EQ(map.between(0.0, 10.0).size(), 5U);
    EXPECT_EQ(map.nearest(0.41).index, 2U);
    EXPECT_GT(map.sizes().learned_bytes, 0U);
  }
  expectUntouched("read");
  EXPECT_EQ(filesOfFolder(), std::vector<std::string>{"garden.perennial"});
}

TEST_F(MapMigrationTest, aMapThatDoesNotNameItsDescriptorComparesIntensities) {
  const MapFile map(file_);
  EXPECT_NO_THROW(requireSameExtraction(map.metadata(), ExtractionSettings::published().describe()));
  ExtractionSettings orientation = ExtractionSettings::published();
  orientation.descriptor = DescriptorKind::kOrientation;
  EXPECT_THROW(requireSameExtraction(map.metadata(), orientation.describe()), MapError);
}

TEST_F(MapMigrationTest, aMapOfFormat1ThatNamesItsDescriptorKeepsIt) {
  MapMetadata metadata = testMetadata();
  metadata.extraction = ExtractionSettings().describe();
  fs::remove(file_);
  {
    std::mt19937_64 random(1);
    MapWriter writer(file_, metadata, false);
    writer.add(randomLocalMap(0, random), randomImage(random));
    writer.finish({}, 1.0);
  }
  OtherProgram(file_).run("PRAGMA user_version = 1");
  EXPECT_EQ(MapFile(file_).formatVersion(), 1U);
  EXPECT_EQ(MapFile(file_).metadata().extraction, metadata.extraction);
  migrate();
  EXPECT_EQ(MapFile(file_).formatVersion(), 2U);
  EXPECT_EQ(MapFile(file_).metadata().extraction, metadata.extraction);
}

TEST_F(MapMigrationTest, whateverWritesMigratesFirstAndKeepsEveryBit) {
  const std::vector<std::function<void(MapFile&)>> writers = {
      [](MapFile& map) {
        map.beginTraversal("latest/1", 1.0);
        EXPECT_EQ(map.formatVersion(), 2U);
        map.discardTraversal();
      },
      [](MapFile& map) { map.rollback(2); },
      [](MapFile& map) { map.compact(10); },
  };
  for (std::size_t i = 0; i < writers.size(); ++i) {
    copyPristine();
    {
      MapFile map(file_);
      writers[i](map);
      EXPECT_EQ(map.metadata().extraction, ExtractionSettings::published().describe());
    }
    expectMigrated("writer " + std::to_string(i));
  }
  EXPECT_EQ(listMaps(folder_ / ""), std::vector<std::string>{"garden"})
      << "the original is no map by its name";
}

TEST_F(MapMigrationTest, theTraversalThatMigratedIsLearnedAndTheNextDoesNotMigrateAgain) {
  std::mt19937_64 random(9);
  const LocalMap state = randomLocalMap(3, random, 8);
  for (std::uint32_t traversal : {3U, 4U}) {
    MapFile map(file_);
    EXPECT_EQ(map.beginTraversal("latest/1", 1.0), traversal);
    map.stage(state);
    map.commitTraversal(2.0);
  }
  EXPECT_TRUE(sameBits(MapFile(file_).readAt(3, 3), state));
  expectMigrated("with two traversals more");
}

TEST_F(MapMigrationTest, keepsThePermissionsOfTheFile) {
  const auto permissions = fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_write;
  fs::permissions(file_, permissions);
  migrate();
  EXPECT_EQ(fs::status(file_).permissions(), permissions);
}

TEST_F(MapMigrationTest, aMapThatAnotherProgramWritesIsRefusedAsEver) {
  OtherProgram other(file_);
  other.run("BEGIN IMMEDIATE");
  EXPECT_NE(errorOf([this] { migrate(); }).find("being updated by another program"), std::string::npos);
  EXPECT_EQ(filesOfFolder(), std::vector<std::string>{"garden.perennial"});
  other.run("ROLLBACK");
  expectUntouched("locked");
  other.run("BEGIN; SELECT * FROM meta");
  migrate();
  expectMigrated("while another program reads");
}

TEST_F(MapMigrationTest, whoeverOpenedTheOriginalBeforeReadsOnButDoesNotWriteToIt) {
  MapFile before(file_);
  migrate();
  EXPECT_TRUE(sameBits(before.read(1), old_.states[2][1]));
  fs::remove(kept_);  // so that only the check itself can prevent a second migration
  EXPECT_NE(errorOf([&] { before.beginTraversal("latest/1", 1.0); }).find("open it again"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(kept_));
  EXPECT_EQ(MapFile(file_).formatVersion(), 2U);
}

TEST_F(MapMigrationTest, aFileWithTheNameOfTheKeptOriginalIsNotOverwritten) {
  std::ofstream(kept_) << "somebody's";
  const std::string error = errorOf([this] { migrate(); });
  for (const char* part : {"format version 1", "migrated to version 2", "move or remove"}) {
    EXPECT_NE(error.find(part), std::string::npos) << error;
  }
  EXPECT_NE(error.find(kept_), std::string::npos) << error;
  const std::vector<char> content = bytesOf(kept_);
  EXPECT_EQ(std::string(content.begin(), content.end()), "somebody's");
  expectUntouched("refused");
}

TEST_F(MapMigrationTest, whatAnInterruptedMigrationLeftBehindDoesNotHinderTheNext) {
  const std::vector<std::function<void()>> remains = {
      [this] { std::ofstream(file_ + ".copy") << "half of it"; },
      [this] { fs::copy_file(file_, file_ + ".copy"); },  // complete, but for its name
      [this] { fs::create_hard_link(file_, kept_); },
      [this] { fs::copy_file(file_, kept_); },
  };
  for (std::size_t i = 0; i < remains.size(); ++i) {
    copyPristine();
    remains[i]();
    migrate();
    expectMigrated("remains " + std::to_string(i));
  }
}

TEST_F(MapMigrationTest, aDamagedMapIsNotMigrated) {
  OtherProgram(file_).run("UPDATE image SET crc = crc + 1 WHERE local_map = 3");
  const std::vector<char> damaged = bytesOf(file_);
  const std::string error = errorOf([this] { migrate(); });
  EXPECT_NE(error.find("image of local map 3"), std::string::npos) << error;
  EXPECT_EQ(bytesOf(file_), damaged);
  EXPECT_EQ(filesOfFolder(), std::vector<std::string>{"garden.perennial"});
}

TEST_F(MapMigrationTest, aMapThatCannotBeMigratedIsUsedWithoutLearning) {
  std::ofstream(kept_) << "somebody's";
  MapManager manager(MapFile(file_), std::make_shared<strategies::LatestMap>());
  manager.beginTraversal(1.0);
  EXPECT_NE(manager.cannotLearn().find("move or remove"), std::string::npos) << manager.cannotLearn();
  EXPECT_EQ(manager.due(0.0).size(), 5U);
  EXPECT_NO_THROW(manager.activeMap(2));
  Observation observation;
  observation.registration.displacement_px = 1.0;
  observation.registration.inliers = 100;
  observation.registration.confidence = 1.0;
  for (const std::uint32_t index : {0U, 1U, 2U, 3U, 4U}) {
    manager.observe(index, 0.2 * index, observation);
  }
  EXPECT_EQ(manager.endTraversal(true, 2.0), 0U);
  manager.beginTraversal(3.0);
  EXPECT_EQ(manager.endTraversal(false, 4.0), 0U);
  expectUntouched("used");
  fs::remove(kept_);
  manager.beginTraversal(5.0);
  EXPECT_EQ(manager.cannotLearn(), "");
  EXPECT_EQ(manager.endTraversal(true, 6.0), 0U);
  expectMigrated("as soon as it can be");
}

}  // namespace
}  // namespace perennial
