#include "core/map/map_schema.h"

#include <string>
#include <vector>

namespace perennial {
namespace {

// Numbers that must come back to the last bit stand in columns without a type: SQLite stores whole numbers in
// REAL columns as integers, which loses the sign of -0.
const std::vector<std::string>& statements() {
  static const std::vector<std::string> kStatements = {
      "CREATE TABLE meta(key TEXT PRIMARY KEY NOT NULL, value NOT NULL, crc INTEGER NOT NULL) WITHOUT ROWID",
      "CREATE TABLE profile(entry INTEGER PRIMARY KEY, distance_m NOT NULL, forward NOT NULL, angular NOT "
      "NULL, "
      "flipper NOT NULL, crc INTEGER NOT NULL)",
      "CREATE TABLE local_map(local_map INTEGER PRIMARY KEY, distance_m NOT NULL, stamp_s NOT NULL, "
      "crc INTEGER NOT NULL)",
      "CREATE INDEX local_map_by_distance ON local_map(distance_m)",
      "CREATE TABLE image(local_map INTEGER PRIMARY KEY, png BLOB NOT NULL, crc INTEGER NOT NULL)",
      "CREATE TABLE traversal(traversal INTEGER PRIMARY KEY, strategy TEXT NOT NULL, start_stamp_s NOT NULL, "
      "end_stamp_s NOT NULL, updated_maps INTEGER NOT NULL, crc INTEGER NOT NULL)",
      "CREATE TABLE state(id INTEGER PRIMARY KEY, local_map INTEGER NOT NULL, traversal INTEGER NOT NULL, "
      "features BLOB NOT NULL, crc INTEGER NOT NULL)",
      "CREATE UNIQUE INDEX state_by_local_map ON state(local_map, traversal)",
  };
  return kStatements;
}

}  // namespace

void createSchema(const Database& database) {
  for (const std::string& statement : statements()) {
    database.execute(statement.c_str());
  }
}

bool hasMapSchema(const Database& database) {
  Statement query(database, "SELECT sql FROM sqlite_master WHERE sql IS NOT NULL ORDER BY rowid");
  std::vector<std::string> found;
  while (query.step()) {
    found.push_back(query.text(0));
  }
  return found == statements();
}

}  // namespace perennial
