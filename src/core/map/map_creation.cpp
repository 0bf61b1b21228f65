#include "core/map/map_creation.h"

#include <string>

#include "core/map/checksum_vfs.h"
#include "core/map/map_schema.h"

namespace perennial {

Database createMap(PartialFile& partial) {
  const Page page = emptyDatabase(kMapApplicationId);
  partial.append(page.data(), page.size());
  Database database = Database::openMap(partial.path());
  database.execute(
      "PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF; PRAGMA locking_mode=EXCLUSIVE; BEGIN EXCLUSIVE");
  createSchema(database);
  return database;
}

void completeMap(const Database& database, PartialFile& partial) {
  database.execute("COMMIT");
  partial.sync();
  database.execute(("PRAGMA user_version=" + std::to_string(kMapFormatVersion)).c_str());
}

}  // namespace perennial
