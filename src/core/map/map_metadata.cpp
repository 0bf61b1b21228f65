// The table `meta`: one row for each member of MapMetadata, under the member's name.
#include <cmath>
#include <limits>
#include <map>

#include "core/map/map_rows.h"
#include "core/map/row_checksum.h"

namespace perennial {
namespace {

constexpr int kMaxImageSide = 1 << 16;
constexpr double kMaxCount = std::numeric_limits<std::uint32_t>::max();

/// What is stored in all rows, by key.
struct Values {
  std::map<std::string, std::string> texts;
  std::map<std::string, double> numbers;
};

std::uint32_t checksum(const std::string& key, const std::string& text) {
  return RowChecksum().add(key).add(text).value();
}
std::uint32_t checksum(const std::string& key, double number) {
  return RowChecksum().add(key).add(number).value();
}

template <typename Value>
void writeValue(const Database& database, const std::string& key, const Value& value) {
  Statement insert(database, "INSERT INTO meta VALUES(?, ?, ?)");
  insert.bind(0, key).bind(1, value).bind(2, std::int64_t{checksum(key, value)}).run();
}

Values readValues(const Database& database) {
  Values values;
  Statement query(database, "SELECT key, value, crc FROM meta");
  while (query.step()) {
    const std::string key = query.text(0);
    const bool is_text = query.type(1) == SQLITE_TEXT;
    const std::uint32_t expected = is_text ? checksum(key, query.text(1)) : checksum(key, query.real(1));
    if (unsigned32(query, 2) != expected) {
      throwDamaged(database.file(), "the checksum of its metadata '" + key + "' is wrong");
    }
    if (is_text) {
      values.texts[key] = query.text(1);
    } else {
      values.numbers[key] = query.real(1);
    }
  }
  return values;
}

template <typename Value>
Value valueOf(const std::map<std::string, Value>& values, const std::string& key, const std::string& file) {
  const auto found = values.find(key);
  if (found == values.end()) {
    throwDamaged(file, "its metadata '" + key + "' is missing");
  }
  return found->second;
}

/// A whole number in [0, maximum].
double countOf(const Values& values, const std::string& key, double maximum, const std::string& file) {
  const double count = valueOf(values.numbers, key, file);
  if (!(count >= 0.0 && count <= maximum) || count != std::floor(count)) {
    throwDamaged(file, "its metadata '" + key + "' is not a count");
  }
  return count;
}

/// In format 1 the descriptor was named unless it compared intensities, the only kind there was at first.
std::string namingTheDescriptor(const std::string& extraction) {
  const bool named = extraction.find(" descriptor=") != std::string::npos;
  return named || extraction.empty() ? extraction : extraction + " descriptor=intensity";
}

}  // namespace

std::string metadataProblem(const MapMetadata& metadata) {
  if (metadata.name.empty()) {
    return "the map's name is empty";
  }
  if (metadata.image_width < 1 || metadata.image_width > kMaxImageSide || metadata.image_height < 1 ||
      metadata.image_height > kMaxImageSide) {
    return "the size of its images, " + std::to_string(metadata.image_width) + "x" +
           std::to_string(metadata.image_height) + " px, is not within 1..65536";
  }
  if (metadata.image_encoding.empty() || metadata.extraction.empty()) {
    return "the encoding of its images or the settings of its extraction are empty";
  }
  if (!(metadata.map_interval_m > 0.0) || !std::isfinite(metadata.map_interval_m)) {
    return "the interval of its local maps is not a positive number";
  }
  if (!(metadata.length_m >= 0.0) || !std::isfinite(metadata.length_m) ||
      !std::isfinite(metadata.taught_stamp_s)) {
    return "its length or the time of its teaching is not a valid number";
  }
  return "";
}

void writeMetadata(const Database& database, const StoredMetadata& stored) {
  const MapMetadata& metadata = stored.metadata;
  writeValue(database, "name", metadata.name);
  writeValue(database, "camera", metadata.camera);
  writeValue(database, "image_width", static_cast<double>(metadata.image_width));
  writeValue(database, "image_height", static_cast<double>(metadata.image_height));
  writeValue(database, "image_encoding", metadata.image_encoding);
  writeValue(database, "extraction", metadata.extraction);
  writeValue(database, "map_interval_m", metadata.map_interval_m);
  writeValue(database, "taught_stamp_s", metadata.taught_stamp_s);
  writeValue(database, "length_m", metadata.length_m);
  writeValue(database, "local_maps", static_cast<double>(stored.local_maps));
  writeValue(database, "profile_entries", static_cast<double>(stored.profile_entries));
}

StoredMetadata readMetadata(const Database& database) {
  const std::string& file = database.file();
  const Values values = readValues(database);
  StoredMetadata stored;
  stored.format_version = static_cast<std::uint32_t>(database.integer("PRAGMA user_version"));
  stored.metadata.name = valueOf(values.texts, "name", file);
  stored.metadata.camera = valueOf(values.texts, "camera", file);
  stored.metadata.image_width = static_cast<int>(countOf(values, "image_width", kMaxImageSide, file));
  stored.metadata.image_height = static_cast<int>(countOf(values, "image_height", kMaxImageSide, file));
  stored.metadata.image_encoding = valueOf(values.texts, "image_encoding", file);
  stored.metadata.extraction = valueOf(values.texts, "extraction", file);
  if (stored.format_version == 1) {
    stored.metadata.extraction = namingTheDescriptor(stored.metadata.extraction);
  }
  stored.metadata.map_interval_m = valueOf(values.numbers, "map_interval_m", file);
  stored.metadata.taught_stamp_s = valueOf(values.numbers, "taught_stamp_s", file);
  stored.metadata.length_m = valueOf(values.numbers, "length_m", file);
  stored.local_maps = static_cast<std::size_t>(countOf(values, "local_maps", kMaxCount, file));
  stored.profile_entries = static_cast<std::size_t>(countOf(values, "profile_entries", kMaxCount, file));
  const std::string problem = metadataProblem(stored.metadata);
  if (!problem.empty()) {
    throwDamaged(file, problem);
  }
  if (stored.local_maps == 0) {
    throwDamaged(file, "it has no local maps");
  }
  return stored;
}

void requireSameExtraction(const MapMetadata& metadata, const std::string& wanted) {
  if (metadata.extraction != wanted) {
    throw MapError("map '" + metadata.name +
                   "' was taught with other extraction settings than those now in use.\n" +
                   "  taught with: " + metadata.extraction + "\n  now in use:  " + wanted +
                   "\nSet the extraction parameters to those of the map, or teach the path again");
  }
}

}  // namespace perennial
