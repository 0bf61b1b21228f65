// The power fails, the disk is full, or one sync alone fails, at every system call of whatever writes a map:
// the map is the old one or the new one, to the bit, and one that was reported as written is there.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <iostream>
#include <optional>

#include "core/map/local_map_codec.h"
#include "failing_calls.h"
#include "format1_map.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;
using How = FailingCalls::How;

constexpr std::uint32_t kLocalMaps = 4;
constexpr std::uint32_t kTraversals = 3;
constexpr std::uint32_t kKept = 1;  // by the compaction
constexpr std::uint64_t kSeeds = 5;

/// All that a map holds, as one string of bytes; "" when there is none. Throws what reading it throws.
std::string contentOf(const std::string& file) {
  if (!fs::exists(file)) {
    return "";
  }
  const MapFile map(file);
  std::string all = std::to_string(map.formatVersion()) + map.metadata().name + map.metadata().extraction;
  const auto add = [&all](const auto& values) {
    const auto* bytes = reinterpret_cast<const char*>(values.data());
    all.append(bytes, values.size() * sizeof(*values.data()));
  };
  add(std::vector<double>{map.metadata().length_m, map.metadata().taught_stamp_s});
  for (const ProfileEntry& entry : map.profile().entries()) {
    const Velocity& velocity = entry.velocity;
    add(std::vector<double>{entry.distance_m, velocity.forward, velocity.angular, velocity.flipper});
  }
  for (const TraversalInfo& traversal : map.traversals()) {
    all += traversal.strategy;
    add(std::vector<double>{traversal.start_stamp_s, traversal.end_stamp_s});
    for (std::uint32_t i = 0; i < map.size(); ++i) {
      add(encodeLocalMap(map.readAt(i, traversal.id)));
    }
  }
  for (std::uint32_t i = 0; i < map.size(); ++i) {
    add(map.readImagePng(i));
  }
  for (const std::string& problem : map.verify()) {
    throw MapError(problem);
  }
  return all;
}

class MapPowerTest : public testing::Test {
 protected:
  using Action = std::function<void(const std::string& file)>;

  MapPowerTest() {
    fs::create_directory(disk_);
    fs::create_directory(disk_ + ".limbo");
    writeMap(pristine_, kLocalMaps);
    std::mt19937_64 random(3);
    for (std::uint32_t traversal = 1; traversal <= kTraversals; ++traversal) {
      traverse(pristine_, random);
    }
  }
  ~MapPowerTest() override { FailingCalls::disarm(); }

  static void traverse(const std::string& file, std::mt19937_64& random) {
    MapFile map(file);
    map.beginTraversal("latest/1", 1.0);
    for (std::uint32_t i = random() % 2; i < kLocalMaps; i += 2) {
      map.stage(randomLocalMap(i, random, 60));
    }
    map.commitTraversal(2.0);
  }
  static void learn(const std::string& file) {
    std::mt19937_64 random(9);
    traverse(file, random);
  }
  static void teach(const std::string& file) { writeMap(file, kLocalMaps, 8, true); }
  static void teachNew(const std::string& file) { writeMap(file, kLocalMaps, 8, false); }
  static void rollBack(const std::string& file) { MapFile(file).rollback(2); }
  static void compact(const std::string& file) { MapFile(file).compact(kKept); }
  static void migrate(const std::string& file) {
    MapFile map(file);
    map.beginTraversal("latest/1", 1.0);
    map.discardTraversal();
  }

  /// The disk as it is before the action; "": without a map.
  void prepare(const std::string& original) {
    for (const std::string& folder : {disk_, disk_ + ".limbo"}) {
      for (const auto& entry : fs::directory_iterator(folder)) {
        fs::remove(entry.path());
      }
    }
    if (!original.empty()) {
      fs::copy_file(original, file_);
    }
  }

  /// What the action makes of it; `before_` and `after_` hold the contents from here on.
  void rehearse(const std::string& original, const Action& action) {
    prepare(original);
    before_ = contentOf(file_);
    action(file_);
    after_ = contentOf(file_);
    ASSERT_TRUE(before_ != after_) << "nothing to be seen of the action";
  }

  /// True when the power was lost on the way, false when afterwards.
  bool losesPowerIn(const Action& action, std::size_t call, std::uint64_t chance) {
    const pid_t child = fork();
    if (child == 0) {
      FailingCalls::armDisk(How::kLosePower, call, disk_, chance);
      const std::string error = errorOf([&] { action(file_); });
      if (!error.empty() || FailingCalls::calls() >= call) {
        std::cerr << "without power: " << error << '\n';
        _exit(2);
      }
      std::ofstream(disk_ + ".returned") << "yes";
      FailingCalls::losePower();
    }
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == FailingCalls::kPowerLost) << status;
    return !fs::remove(disk_ + ".returned");
  }

  /// 2: the new map, 1: the old one, 0: anything else.
  int stateOfMap(const std::string& when) {
    std::string content;
    const std::string error = errorOf([&] { content = contentOf(file_); });
    EXPECT_EQ(error, "") << when;
    const int state = content == after_ ? 2 : content == before_ ? 1 : 0;
    EXPECT_NE(state, 0) << when;
    return error.empty() ? state : 0;
  }

  void expectThatItCanBeDoneAgain(const Action& action, const std::string& when) {
    const std::string error = errorOf([&] { action(file_); });
    if (error.find("finished map") != std::string::npos) {  // and so it is
      EXPECT_EQ(contentOf(file_ + ".partial"), after_) << when;
      return;
    }
    EXPECT_EQ(error, "") << when;
    EXPECT_EQ(contentOf(file_), after_) << when;
  }

  void expectPowerLossHarmless(const std::string& original, const Action& action) {
    rehearse(original, action);
    std::size_t old_maps = 0;
    std::size_t new_maps = 0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      bool on_the_way = true;
      for (std::size_t call = 1; on_the_way; ++call) {
        prepare(original);
        on_the_way = losesPowerIn(action, call, seed * 1000 + call);
        const std::string when = "seed " + std::to_string(seed) + ", call " + std::to_string(call);
        const int state = stateOfMap(when);
        ASSERT_NE(state, 0) << when;
        EXPECT_TRUE(on_the_way || state == 2) << "lost although it was done: " << when;
        (state == 2 ? new_maps : old_maps) += 1;
        if (state == 1) {
          expectThatItCanBeDoneAgain(action, when);
        }
      }
    }
    std::cout << old_maps << " times the old map, " << new_maps << " times the new one\n";
    EXPECT_GE(old_maps, kSeeds * 10);
    EXPECT_GE(new_maps, kSeeds);
  }

  /// On a full disk any call may fail, also one that only a later one makes up for.
  void expectFullDiskHarmless(const std::string& original, const Action& action) {
    rehearse(original, action);
    std::size_t failures = 0;
    for (std::size_t call = 1;; ++call) {
      prepare(original);
      FailingCalls::arm(How::kFail, call);
      const std::string error = errorOf([&] { action(file_); });
      const bool failed = FailingCalls::calls() >= call;
      FailingCalls::disarm();
      const std::string when = "call " + std::to_string(call) + ": " + error;
      const int state = stateOfMap(when);
      ASSERT_NE(state, 0) << when;
      EXPECT_TRUE(state == 2 || !error.empty()) << when;
      if (!failed) {
        break;
      }
      failures += error.empty() ? 0 : 1;
      if (state == 1) {
        expectThatItCanBeDoneAgain(action, when);
      }
    }
    EXPECT_GE(failures, 10U);
  }

  /// What the action throws when this sync fails; nothing when there are not so many.
  std::optional<std::string> errorOfSync(const Action& action, std::size_t sync, std::uint64_t chance) {
    FailingCalls::armDisk(How::kFailSync, sync, disk_, chance);
    const std::string error = errorOf([&] { action(file_); });
    const bool failed = FailingCalls::calls() >= sync;
    FailingCalls::disarm();
    return failed ? std::optional<std::string>(error) : std::nullopt;
  }

  /// `unnoticed`: the syncs of the folder for a journal's name, of which SQLite does not ask whether they
  /// succeed. The action is done then.
  void expectLoneFailingSyncHarmless(const std::string& original, const Action& action, std::size_t syncs,
                                     std::size_t unnoticed = 0) {
    rehearse(original, action);
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      std::size_t failed = 0;
      std::size_t reported = 0;
      for (;; ++failed) {
        prepare(original);
        const std::size_t sync = failed + 1;
        const auto error = errorOfSync(action, sync, seed * 1000 + sync);
        const std::string when = "seed " + std::to_string(seed) + ", sync " + std::to_string(sync);
        const int state = stateOfMap(when);
        ASSERT_NE(state, 0) << when;
        if (!error) {
          break;
        }
        reported += error->empty() ? 0 : 1;
        EXPECT_TRUE(error->empty() ? state == 2 : error->find("heck the disk") != std::string::npos)
            << when << ": " << *error;
      }
      EXPECT_GE(failed, syncs);
      EXPECT_EQ(reported, failed - unnoticed);
    }
  }

  TemporaryFolder folder_;
  const std::string disk_ = folder_ / "disk";
  const std::string file_ = disk_ + "/garden.perennial";
  const std::string pristine_ = folder_ / "pristine.perennial";
  std::string before_;
  std::string after_;
};

TEST_F(MapPowerTest, aFullDiskWhileATraversalIsCommitted) { expectFullDiskHarmless(pristine_, learn); }
TEST_F(MapPowerTest, aFullDiskWhileRollingBack) { expectFullDiskHarmless(pristine_, rollBack); }
TEST_F(MapPowerTest, aFullDiskWhileTeaching) { expectFullDiskHarmless("", teachNew); }
TEST_F(MapPowerTest, aFullDiskWhileTeachingOverAMap) { expectFullDiskHarmless(pristine_, teach); }
TEST_F(MapPowerTest, aFullDiskWhileCompacting) { expectFullDiskHarmless(pristine_, compact); }

TEST_F(MapPowerTest, powerLossWhileATraversalIsCommitted) { expectPowerLossHarmless(pristine_, learn); }
TEST_F(MapPowerTest, powerLossWhileRollingBack) { expectPowerLossHarmless(pristine_, rollBack); }
TEST_F(MapPowerTest, powerLossWhileTeaching) { expectPowerLossHarmless("", teachNew); }
TEST_F(MapPowerTest, powerLossWhileTeachingOverAMap) { expectPowerLossHarmless(pristine_, teach); }
TEST_F(MapPowerTest, powerLossWhileCompacting) {
  expectPowerLossHarmless(pristine_, compact);
  const MapFile whole(pristine_);
  const MapFile compacted(file_);
  ASSERT_EQ(compacted.traversals().size(), 2U + kKept) << "taught, merged, kept";
  for (std::uint32_t i = 0; i < kLocalMaps; ++i) {
    EXPECT_TRUE(sameBits(compacted.read(i), whole.read(i)));
    EXPECT_TRUE(sameBits(compacted.readAt(i, 1), whole.readAt(i, kTraversals - kKept)));
    EXPECT_TRUE(sameBits(compacted.readAt(i, 0), whole.readAt(i, 0)));
    EXPECT_EQ(compacted.readImagePng(i), whole.readImagePng(i));
  }
}
TEST_F(MapPowerTest, powerLossWhileMigrating) { expectPowerLossHarmless(FORMAT1_MAP, migrate); }

TEST_F(MapPowerTest, aSyncFailsWhileATraversalIsCommitted) {
  expectLoneFailingSyncHarmless(pristine_, learn, 5, 1);
}
TEST_F(MapPowerTest, aSyncFailsWhileRollingBack) { expectLoneFailingSyncHarmless(pristine_, rollBack, 5, 1); }
TEST_F(MapPowerTest, aSyncFailsWhileTeaching) { expectLoneFailingSyncHarmless("", teachNew, 3); }
TEST_F(MapPowerTest, aSyncFailsWhileTeachingOverAMap) { expectLoneFailingSyncHarmless(pristine_, teach, 3); }
TEST_F(MapPowerTest, aSyncFailsWhileCompacting) { expectLoneFailingSyncHarmless(pristine_, compact, 3); }
TEST_F(MapPowerTest, aSyncFailsWhileMigrating) { expectLoneFailingSyncHarmless(FORMAT1_MAP, migrate, 4); }

TEST_F(MapPowerTest, aCommitThatMayYetBeLostSaysSoAndIsNotCommittedTwice) {
  prepare(pristine_);
  ASSERT_FALSE(errorOfSync(learn, 1000, 1).has_value());
  const std::size_t last = FailingCalls::calls();  // of the folder, when the journal was removed
  prepare(pristine_);
  MapFile map(file_);
  std::mt19937_64 random(9);
  const std::uint32_t id = map.beginTraversal("latest/1", 1.0);
  map.stage(randomLocalMap(0, random));
  const auto error = errorOfSync([&](const std::string&) { map.commitTraversal(2.0); }, last, 1);
  ASSERT_TRUE(error.has_value());
  EXPECT_NE(error->find("may be lost if the power fails"), std::string::npos) << *error;
  EXPECT_THROW(map.commitTraversal(2.0), MapError);
  EXPECT_EQ(map.traversals().back().id, id);
  EXPECT_EQ(map.beginTraversal("latest/1", 3.0), id + 1);
}

TEST_F(MapPowerTest, aMapThatCouldNotBeSyncedIsNotGivenItsNameLater) {
  for (const std::size_t sync : {1U, 2U}) {  // of what the map holds; of the mark that it is complete
    prepare(pristine_);
    MapWriter writer(file_, testMetadata(), true);
    std::mt19937_64 random(9);
    writer.add(randomLocalMap(0, random), randomImage(random));
    const auto error = errorOfSync([&](const std::string&) { writer.finish({}, 1.0); }, sync, 1);
    ASSERT_TRUE(error.has_value());
    EXPECT_NE(error->find("cannot be synced"), std::string::npos) << *error;
    EXPECT_NE(errorOf([&] { writer.finish({}, 1.0); }).find("failed before"), std::string::npos);
    EXPECT_EQ(MapFile(file_).size(), kLocalMaps);
  }
}

}  // namespace
}  // namespace perennial
