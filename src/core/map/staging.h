#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/map/local_map_codec.h"
#include "core/map/sqlite.h"

namespace perennial {

/// States of local maps that a traversal has changed and not committed. They wait in a temporary database of
/// their own, on disk (SQLITE_TMPDIR, TMPDIR, /var/tmp or /tmp), so that neither memory nor the map file
/// grows.
class Staging {
 public:
  /// `file`: the map, for error messages.
  explicit Staging(const std::string& file);

  /// Replaces what was staged before for this local map.
  void put(std::uint32_t local_map, const Bytes& features);
  std::optional<Bytes> find(std::uint32_t local_map) const;
  std::size_t size() const;

  /// Calls `use(local_map, features)` for each, by rising index.
  template <typename Use>
  void forEach(Use use) const {
    Statement query(database_, "SELECT local_map, features FROM staged ORDER BY local_map");
    while (query.step()) {
      use(static_cast<std::uint32_t>(query.integer(0)), query.blob(1));
    }
  }

 private:
  Database database_;
};

}  // namespace perennial
