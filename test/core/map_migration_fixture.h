#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "format1_map.h"

namespace perennial {

/// A folder in which a map of format version 1 is migrated, and what is to hold before and after.
class MigrationFixture : public testing::Test {
 protected:
  /// The folder with the map of format version 1, and nothing else.
  void copyPristine() {
    namespace fs = std::filesystem;
    for (const std::string& name : filesOfFolder()) {
      fs::remove(folder_ / name);  // also the map itself: not written over, for it may have two names
    }
    fs::copy_file(FORMAT1_MAP, file_);
  }
  std::vector<std::string> filesOfFolder() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }
  /// By what a robot does: it begins to learn.
  void migrate() const {
    MapFile map(file_);
    map.beginTraversal("latest/1", 1.0);
    map.discardTraversal();
  }
  void expectUntouched(const std::string& when) const {
    EXPECT_EQ(bytesOf(file_), original_) << when;
    EXPECT_EQ(old_.differenceFrom(file_), "") << when;
  }
  /// Wholly, with the original beside it.
  void expectMigrated(const std::string& when) const {
    EXPECT_EQ(old_.differenceFrom(file_), "") << when;
    EXPECT_EQ(MapFile(file_).formatVersion(), 2U) << when;
    EXPECT_EQ(bytesOf(kept_), original_) << when;
    EXPECT_EQ(filesOfFolder(), (std::vector<std::string>{"garden.perennial", "garden.perennial.format1"}))
        << when;
  }

  TemporaryFolder folder_;
  const std::string file_ = folder_ / "garden.perennial";
  const std::string kept_ = file_ + ".format1";
  const std::vector<char> original_ = bytesOf(FORMAT1_MAP);
  const Format1Map old_;
};

}  // namespace perennial
