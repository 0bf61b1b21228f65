// Disk full, power loss, a dying process and a disk that lies, at every single step of a migration.
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include <iostream>

#include "failing_calls.h"
#include "faulty_vfs.h"
#include "map_migration_fixture.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;
using How = FailingCalls::How;

class MapMigrationFaultTest : public MigrationFixture {
 protected:
  MapMigrationFaultTest() { disk_.reset(); }
  ~MapMigrationFaultTest() override {
    FailingCalls::disarm();
    disk_.reset();
  }

  /// "" when it went well. Only ever a MigrationError, with the file's name.
  std::string errorOfMigration() const {
    try {
      migrate();
    } catch (const MigrationError& error) {
      EXPECT_NE(std::string(error.what()).find(file_), std::string::npos) << error.what();
      return error.what();
    } catch (const Error& error) {
      ADD_FAILURE() << error.what();
      return error.what();
    }
    return "";
  }
  /// Old or new.
  void expectWhole(const std::string& when) const {
    EXPECT_EQ(old_.differenceFrom(file_), "") << when;
    EXPECT_EQ(bytesOf(MapFile(file_).formatVersion() == 1 ? file_ : kept_), original_) << when;
  }

  FaultyDisk& disk_ = FaultyDisk::instance();
};

TEST_F(MapMigrationFaultTest, aFullDiskHarmsNothingAndSaysWhatToDo) {
  std::size_t failures = 0;
  for (std::size_t event = 1;; ++event) {
    copyPristine();
    disk_.failFrom(event, SQLITE_FULL);
    const std::string error = errorOfMigration();
    disk_.reset();
    const std::string when = "event " + std::to_string(event);
    if (error.empty()) {
      expectMigrated(when);
      break;
    }
    ++failures;
    EXPECT_NE(error.find("free some space"), std::string::npos) << error;
    EXPECT_FALSE(fs::exists(file_ + ".copy")) << when;
    EXPECT_FALSE(fs::exists(kept_)) << when;
    expectUntouched(when);
    migrate();
    expectMigrated(when);
  }
  EXPECT_GE(failures, 9U) << "as many as the map has pages";
}

TEST_F(MapMigrationFaultTest, whereThereIsNoRoomNothingIsWritten) {
  copyPristine();
  FailingCalls::arm(How::kNoRoom, 0);
  const std::string error = errorOfMigration();
  const std::size_t calls = FailingCalls::calls();
  FailingCalls::disarm();
  EXPECT_NE(error.find("needs 1 MB"), std::string::npos) << error;
  EXPECT_NE(error.find("free some space"), std::string::npos) << error;
  EXPECT_EQ(calls, 0U);
  EXPECT_EQ(disk_.events(), 0U);
  expectUntouched("no room");
}

TEST_F(MapMigrationFaultTest, powerLossLeavesTheOldMap) {
  std::size_t losses = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    for (std::size_t event = 1;; ++event) {
      copyPristine();
      disk_.losePowerAt(event, seed * 1000 + event);
      const std::string error = errorOf([this] { migrate(); });
      const bool power_was_lost = disk_.powerIsLost();
      disk_.reset();
      const std::string when = "seed " + std::to_string(seed) + ", event " + std::to_string(event);
      if (!power_was_lost) {
        EXPECT_EQ(error, "");
        expectMigrated(when);
        break;
      }
      ++losses;
      expectUntouched(when);
      migrate();
      expectMigrated(when);
    }
  }
  EXPECT_GE(losses, 45U);
}

TEST_F(MapMigrationFaultTest, everySystemCallMayFail) {
  std::size_t failures = 0;
  for (std::size_t call = 1;; ++call) {
    copyPristine();
    FailingCalls::arm(How::kFail, call);
    const std::string error = errorOfMigration();
    const std::size_t calls = FailingCalls::calls();
    FailingCalls::disarm();
    const std::string when = "call " + std::to_string(call) + ": " + error;
    expectWhole(when);
    if (calls < call) {
      EXPECT_EQ(error, "");
      break;
    }
    failures += error.empty() ? 0 : 1;
    migrate();
    expectMigrated(when);
  }
  EXPECT_GE(failures, 13U) << "writing each page, syncing, renaming";
}

TEST_F(MapMigrationFaultTest, theProcessMayDieAtEveryStep) {
  std::size_t old_maps = 0;
  std::size_t new_maps = 0;
  for (std::size_t call = 1;; ++call) {
    copyPristine();
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      FailingCalls::arm(How::kDie, call);
      const bool migrated = errorOf([this] { migrate(); }).empty();
      FailingCalls::disarm();
      _exit(migrated ? 1 : 2);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFEXITED(status));
    const std::string when = "call " + std::to_string(call);
    expectWhole(when);
    (MapFile(file_).formatVersion() == 1 ? old_maps : new_maps) += 1;
    migrate();
    expectMigrated(when);
    if (WEXITSTATUS(status) != 0) {
      EXPECT_EQ(WEXITSTATUS(status), 1) << "died of something else";
      break;
    }
  }
  std::cout << old_maps << " times the old map, " << new_maps << " times the new one\n";
  EXPECT_GE(old_maps, 13U);
  EXPECT_GE(new_maps, 2U) << "after the renaming, and when nothing happens";
}

TEST_F(MapMigrationFaultTest, aCopyThatTheDiskSpoilsIsFound) {
  std::size_t spoilt = 0;
  for (std::size_t call = 1;; ++call) {
    copyPristine();
    FailingCalls::arm(How::kCorrupt, call);
    const std::string error = errorOf([this] { migrate(); });
    const std::size_t calls = FailingCalls::calls();
    const bool corrupted = FailingCalls::hasCorrupted();
    FailingCalls::disarm();
    if (calls < call) {
      break;
    }
    if (!corrupted || error.empty()) {  // not a write; or of the first page, which is written again
      expectMigrated("call " + std::to_string(call));
      continue;
    }
    ++spoilt;
    expectUntouched("call " + std::to_string(call));
    EXPECT_FALSE(fs::exists(kept_));
  }
  EXPECT_GE(spoilt, 9U) << "each page";
}

TEST_F(MapMigrationFaultTest, whereThereAreNoHardLinksTheOriginalIsCopied) {
  copyPristine();
  FailingCalls::arm(How::kNoLinks, 0);
  migrate();
  FailingCalls::disarm();
  expectMigrated("copied");
  EXPECT_EQ(fs::hard_link_count(kept_), 1U);
}

}  // namespace
}  // namespace perennial
