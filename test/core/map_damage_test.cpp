// Files that are no maps, and maps that were damaged: every fault is found and named, none crashes.
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <boost/crc.hpp>
#include <cstdio>
#include <fstream>
#include <iostream>

#include "map_test_support.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

using Content = std::vector<char>;

Content contentOf(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return Content(std::istreambuf_iterator<char>(stream), {});
}

void writeContent(const std::string& file, const Content& content) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
}

void runSql(const std::string& file, const char* sql, const char* vfs = nullptr) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open_v2(file.c_str(), &database, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, vfs),
            SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(database);
  sqlite3_close(database);
}

/// Through the layer of page checksums, so that only the rows' own checks can notice.
void forge(const std::string& file, const char* sql) { runSql(file, sql, "perennial-checksum"); }

class MapDamageTest : public testing::Test {
 protected:
  MapDamageTest() {
    writeMap(file_, 8);
    std::mt19937_64 random(4);
    MapFile map(file_);
    for (int traversal = 1; traversal <= 3; ++traversal) {
      map.beginTraversal("latest/1", 100.0 * traversal);
      for (std::uint32_t i = 0; i < 8; i += 2) {
        map.stage(randomLocalMap(i, random));
      }
      map.commitTraversal(100.0 * traversal + 50.0);
    }
    map.rollback(2);  // leaves pages that are in no use
  }

  /// The first thing that opening or verifying complains of, "" when all is well.
  std::string complaint() const {
    std::string first;
    const std::string error = errorOf([&] {
      const MapFile map(file_);
      const std::vector<std::string> problems = map.verify();
      first = problems.empty() ? "" : problems.front();
    });
    return error.empty() ? first : error;
  }
  std::string openingError() const {
    return errorOf([&] { MapFile map(file_); });
  }
  void expectMentions(const std::string& error, const std::vector<std::string>& words) const {
    EXPECT_NE(error.find(file_), std::string::npos) << error;
    for (const std::string& word : words) {
      EXPECT_NE(error.find(word), std::string::npos) << "'" << word << "' is not in: " << error;
    }
  }

  TemporaryFolder folder_;
  const std::string file_ = folder_ / "garden.perennial";
};

TEST_F(MapDamageTest, everyFlippedBitIsFound) {
  ASSERT_EQ(complaint(), "");
  const Content sound = contentOf(file_);
  std::mt19937_64 random(11);
  constexpr int kFlips = 4000;
  int found = 0;
  std::fstream stream(file_, std::ios::binary | std::ios::in | std::ios::out);
  for (int i = 0; i < kFlips; ++i) {
    // The first page, with SQLite's header, gets a quarter of them.
    const std::size_t at = random() % (i % 4 == 0 ? 4096 : sound.size());
    stream.seekp(static_cast<std::streamoff>(at));
    stream.put(static_cast<char>(sound[at] ^ (1 << random() % 8))).flush();
    const bool noticed = !complaint().empty();
    EXPECT_TRUE(noticed) << "byte " << at;
    found += noticed ? 1 : 0;
    stream.seekp(static_cast<std::streamoff>(at));
    stream.put(sound[at]).flush();
  }
  std::cout << found << " of " << kFlips << " flipped bits found in a map of " << sound.size() << " bytes\n";
  EXPECT_EQ(complaint(), "");
}

TEST_F(MapDamageTest, everyTruncationIsFound) {
  const Content sound = contentOf(file_);
  for (std::size_t size = 0; size < sound.size(); size += 512) {
    fs::resize_file(file_, size);
    EXPECT_NE(complaint(), "") << size << " bytes";
    writeContent(file_, sound);
  }
  Content longer = sound;
  longer.resize(sound.size() + 4096);
  writeContent(file_, longer);
  EXPECT_NE(complaint().find("bytes long"), std::string::npos) << complaint();
}

TEST_F(MapDamageTest, pagesOverwrittenOrExchangedAreFound) {
  const Content sound = contentOf(file_);
  const std::size_t pages = sound.size() / 4096;
  std::mt19937_64 random(5);
  for (std::size_t page = 0; page < pages; ++page) {
    Content content = sound;
    for (std::size_t i = 0; i < 4096; ++i) {
      content[page * 4096 + i] = static_cast<char>(random());
    }
    writeContent(file_, content);
    EXPECT_NE(complaint(), "") << "page " << page + 1 << " overwritten";
    const std::size_t other = (page + 1) % pages;
    content = sound;
    std::swap_ranges(content.begin() + static_cast<std::ptrdiff_t>(page * 4096),
                     content.begin() + static_cast<std::ptrdiff_t>(page * 4096 + 4096),
                     content.begin() + static_cast<std::ptrdiff_t>(other * 4096));
    writeContent(file_, content);
    EXPECT_NE(complaint(), "") << "page " << page + 1 << " exchanged";
  }
}

TEST_F(MapDamageTest, aDamagedLocalMapIsNamedAndTheOthersAreRead) {
  forge(file_, "UPDATE state SET features = zeroblob(length(features)) WHERE local_map = 3");
  const MapFile map(file_);
  expectMentions(errorOf([&] { map.read(3); }), {"local map 3", "checksum", "verify"});
  EXPECT_NO_THROW(map.read(4));
  EXPECT_EQ(map.verify().size(), 1U);
}

TEST_F(MapDamageTest, aDamagedImageIsNamed) {
  forge(file_, "UPDATE image SET png = x'00' WHERE local_map = 5");
  expectMentions(errorOf([&] { MapFile(file_).readImage(5); }), {"image of local map 5", "checksum"});
}

TEST_F(MapDamageTest, anImageThatIsNoneIsNamedThoughItsChecksumIsRight) {
  const auto crcOf = [](const std::vector<std::uint8_t>& png) {
    boost::crc_32_type crc;
    const std::uint32_t local_map = 5;
    crc.process_bytes(&local_map, sizeof(local_map));
    crc.process_bytes(png.data(), png.size());
    return std::to_string(crc.checksum());
  };
  forge(file_, ("UPDATE image SET png = x'', crc = " + crcOf({}) + " WHERE local_map = 5").c_str());
  expectMentions(errorOf([&] { MapFile(file_).readImage(5); }),
                 {"image of local map 5", "no grey PNG of 12x8 px"});
  // The beginning of a PNG that promises the right size, and nothing else.
  std::vector<std::uint8_t> png = MapFile(file_).readImagePng(4);
  png.resize(30);
  std::string hex;
  for (const std::uint8_t byte : png) {
    char digits[3];
    std::snprintf(digits, sizeof(digits), "%02x", byte);
    hex += digits;
  }
  forge(file_,
        ("UPDATE image SET png = x'" + hex + "', crc = " + crcOf(png) + " WHERE local_map = 5").c_str());
  expectMentions(errorOf([&] { MapFile(file_).readImage(5); }),
                 {"image of local map 5", "no grey PNG of 12x8 px"});
}

TEST_F(MapDamageTest, changedRowsAreFound) {
  const Content sound = contentOf(file_);
  const std::vector<const char*> forgeries = {
      "UPDATE local_map SET distance_m = distance_m + 1 WHERE local_map = 2",
      "UPDATE local_map SET stamp_s = 0 WHERE local_map = 2",
      "DELETE FROM local_map WHERE local_map = 7",
      "DELETE FROM image WHERE local_map = 7",
      "DELETE FROM state WHERE local_map = 7",
      "DELETE FROM state WHERE local_map = 2 AND traversal = 2",
      "UPDATE state SET traversal = 9 WHERE local_map = 2 AND traversal = 2",
      "UPDATE state SET local_map = 3 WHERE local_map = 2 AND traversal = 2",
      "INSERT INTO state SELECT NULL, 99, traversal, features, crc FROM state LIMIT 1",
      "UPDATE traversal SET end_stamp_s = 1 WHERE traversal = 1",
      "DELETE FROM traversal WHERE traversal = 2",
      "DELETE FROM traversal",
      "UPDATE profile SET forward = 2 WHERE entry = 1",
      "DELETE FROM profile WHERE entry = 2",
      "DELETE FROM meta WHERE key = 'camera'",
      "UPDATE meta SET value = 13 WHERE key = 'image_width'",
      "UPDATE meta SET value = NULL WHERE key = 'x'; UPDATE meta SET value = 'x' WHERE key = 'length_m'",
      "DELETE FROM meta",
      "DROP INDEX local_map_by_distance",
      "DROP TABLE image",
      "CREATE TABLE more(a)",
      "CREATE TRIGGER t AFTER INSERT ON state BEGIN DELETE FROM state; END",
      "PRAGMA user_version = 3",
      "PRAGMA user_version = 0",
      "PRAGMA application_id = 1",
  };
  for (const char* sql : forgeries) {
    writeContent(file_, sound);
    forge(file_, sql);
    EXPECT_NE(complaint(), "") << sql;
  }
}

TEST_F(MapDamageTest, missingAndInvalidMetadataIsNamed) {
  forge(file_, "DELETE FROM meta WHERE key = 'camera'");
  expectMentions(openingError(), {"'camera' is missing"});
}

TEST_F(MapDamageTest, missingFile) {
  fs::remove(file_);
  expectMentions(openingError(), {"does not exist", "check its name"});
}

TEST_F(MapDamageTest, notAMap) {
  writeContent(file_, {});
  expectMentions(openingError(), {"empty", "teach the path again"});
  std::mt19937_64 random(1);
  for (std::size_t size : {1U, 50U, 100U, 4096U, 100000U}) {
    Content noise(size);
    for (char& byte : noise) {
      byte = static_cast<char>(random());
    }
    writeContent(file_, noise);
    expectMentions(openingError(), {"not a map", "no SQLite file"});
  }
  fs::remove(file_);
  fs::create_directory(file_);
  expectMentions(openingError(), {"is a folder"});
}

TEST_F(MapDamageTest, anotherProgramsDatabase) {
  for (const char* sql :
       {"PRAGMA page_size=4096; CREATE TABLE t(a)", "PRAGMA page_size=1024; CREATE TABLE t(a)",
        "PRAGMA page_size=65536; CREATE TABLE t(a)", "PRAGMA journal_mode=WAL; CREATE TABLE t(a)"}) {
    fs::remove(file_);
    runSql(file_, sql);
    expectMentions(openingError(), {"not a map", "another program"});
  }
}

TEST_F(MapDamageTest, newerFormat) {
  forge(file_, "PRAGMA user_version = 3");
  expectMentions(openingError(), {"format version 3", "up to 2", "newer program"});
  runSql(file_, "CREATE TABLE newer(a)");  // without page checksums, as a newer format might be
  expectMentions(openingError(), {"format version 3", "up to 2", "newer program"});
}

TEST_F(MapDamageTest, unfinishedTeaching) {
  const std::string other = folder_ / "other.perennial";
  std::mt19937_64 random(1);
  MapWriter writer(other, testMetadata(), false);
  for (std::uint32_t i = 0; i < 200; ++i) {
    writer.add(randomLocalMap(i, random), randomImage(random));
  }
  fs::copy_file(other + ".partial", file_, fs::copy_options::overwrite_existing);
  const std::string error = openingError();
  expectMentions(error, {"unfinished", "teach the path again"});
}

TEST_F(MapDamageTest, writtenByAProgramWithoutChecksums) {
  runSql(file_, "UPDATE local_map SET stamp_s = 1");
  EXPECT_NE(complaint(), "");
}

TEST_F(MapDamageTest, anySqliteProgramReadsAMap) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open_v2(file_.c_str(), &database, SQLITE_OPEN_READONLY, nullptr), SQLITE_OK);
  std::string result;
  const auto keep = [](void* text, int, char** columns, char**) {
    *static_cast<std::string*>(text) += columns[0];
    return 0;
  };
  EXPECT_EQ(sqlite3_exec(database, "PRAGMA integrity_check; SELECT count(*) FROM local_map", keep, &result,
                         nullptr),
            SQLITE_OK);
  sqlite3_close(database);
  EXPECT_EQ(result, "ok8");
}

}  // namespace
}  // namespace perennial
