#include "perennial/core/map_name.h"

#include <gtest/gtest.h>

#include <fstream>

#include "map_test_support.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

TEST(MapName, acceptsPlainNames) {
  for (const std::string& name : {std::string("garden"), std::string("a"), std::string("A-1_b.2"),
                                  std::string("2026-06-21"), std::string("a..b"), std::string(100, 'x')}) {
    EXPECT_EQ(mapFile("/maps", name), "/maps/" + name + ".perennial");
  }
}

TEST(MapName, cannotLeaveTheFolder) {
  for (const std::string& name :
       {std::string(), std::string("."), std::string(".."), std::string("../x"), std::string("a/b"),
        std::string("/etc/x"), std::string(".hidden"), std::string("-rf"), std::string("a b"),
        std::string("a\nb"), std::string("a\0b", 3), std::string("caf\xc3\xa9"), std::string("a\\b"),
        std::string("~"), std::string("$(x)"), std::string(101, 'x'), std::string("garden.perennial")}) {
    EXPECT_NE(errorOf([&] { mapFile("/maps", name); }).find("cannot be the name of a map"), std::string::npos)
        << name;
  }
}

TEST(MapName, anUnknownMapIsToldFromThoseThatExist) {
  TemporaryFolder folder;
  for (const char* file :
       {"shed.perennial", "garden.perennial", "garden.perennial.partial", "notes.txt", ".perennial"}) {
    std::ofstream(folder / file) << "x";
  }
  EXPECT_EQ(listMaps(folder / ""), (std::vector<std::string>{"garden", "shed"}));
  EXPECT_EQ(existingMapFile(folder / "", "shed"), folder / "shed.perennial");
  const std::string error = errorOf([&] { existingMapFile(folder / "", "sheds"); });
  EXPECT_NE(error.find("no map 'sheds'"), std::string::npos) << error;
  EXPECT_NE(error.find("garden, shed"), std::string::npos) << error;
}

TEST(MapName, aFolderWithoutMapsSaysSo) {
  TemporaryFolder folder;
  EXPECT_TRUE(listMaps(folder / "missing").empty());
  EXPECT_NE(errorOf([&] { existingMapFile(folder / "missing", "x"); }).find("no maps"), std::string::npos);
  std::ofstream(folder / "file") << "x";
  EXPECT_NE(errorOf([&] { listMaps(folder / "file"); }).find("cannot be read"), std::string::npos);
}

}  // namespace
}  // namespace perennial
