#include "core/map/staging.h"

namespace perennial {

Staging::Staging(const std::string& file) : database_(Database::openTemporary(file)) {
  database_.execute("CREATE TABLE staged(local_map INTEGER PRIMARY KEY, features BLOB NOT NULL)");
}

void Staging::put(std::uint32_t local_map, const Bytes& features) {
  Statement insert(database_, "INSERT OR REPLACE INTO staged VALUES(?, ?)");
  insert.bind(0, std::int64_t{local_map}).bind(1, features).run();
}

std::optional<Bytes> Staging::find(std::uint32_t local_map) const {
  Statement query(database_, "SELECT features FROM staged WHERE local_map = ?");
  query.bind(0, std::int64_t{local_map});
  return query.step() ? std::optional<Bytes>(query.blob(0)) : std::nullopt;
}

std::size_t Staging::size() const {
  return static_cast<std::size_t>(database_.integer("SELECT count(*) FROM staged"));
}

}  // namespace perennial
