#include <cmath>
#include <optional>

#include "core/map/local_map_codec.h"
#include "core/map/map_creation.h"
#include "core/map/map_image.h"
#include "core/map/map_rows.h"
#include "core/map/publish_file.h"
#include "core/map/sqlite.h"
#include "perennial/core/map_file.h"

namespace perennial {

/// One transaction from the first local map to the last.
struct MapWriter::Implementation {
  Implementation(const std::string& file, const MapMetadata& metadata_in, bool overwrite_in)
      : metadata(metadata_in), overwrite(overwrite_in), partial(file) {
    database.emplace(createMap(partial));
    insert_place.emplace(*database, "INSERT INTO local_map VALUES(?, ?, ?, ?)");
    insert_image.emplace(*database, "INSERT INTO image VALUES(?, ?, ?)");
    insert_state.emplace(*database, "INSERT INTO state VALUES(NULL, ?, 0, ?, ?)");
  }

  void requireSound() const;
  void check(const LocalMap& map, const cv::Mat& image) const;
  void add(const LocalMap& map, const cv::Mat& image);
  void complete(const PathProfile& profile, double length_m);

  MapMetadata metadata;
  bool overwrite;
  PartialFile partial;  // outlives the connection, which is closed before the file is removed
  std::optional<Database> database;
  std::optional<Statement> insert_place;
  std::optional<Statement> insert_image;
  std::optional<Statement> insert_state;
  bool broken = false;  // without a journal, nothing can be made of a database after a failed statement
  std::size_t local_maps = 0;
  double last_distance_m = 0.0;
  double last_stamp_s = 0.0;
};

void MapWriter::Implementation::requireSound() const {
  if (broken) {
    throw MapError("map '" + metadata.name +
                   "': writing it has failed before (disk full?); teach the path again");
  }
}

void MapWriter::Implementation::check(const LocalMap& map, const cv::Mat& image) const {
  const std::string name = "map '" + metadata.name + "', local map " + std::to_string(map.index);
  requireSound();
  if (!database) {
    throw MapError(name + ": the map is finished already");
  }
  if (map.index != local_maps) {
    throw MapError(name + ": its index should be " + std::to_string(local_maps));
  }
  const std::string problem = map.problem();
  if (!problem.empty()) {
    throw MapError(name + ": " + problem);
  }
  if (map.distance_m < last_distance_m) {
    throw MapError(name + ": its distance, " + std::to_string(map.distance_m) +
                   " m, is less than the last one's, " + std::to_string(last_distance_m) + " m");
  }
  if (image.type() != CV_8UC1 || image.cols != metadata.image_width || image.rows != metadata.image_height) {
    throw ImageError(name + ": its image is " + std::to_string(image.cols) + "x" +
                     std::to_string(image.rows) + " px of OpenCV type " + std::to_string(image.type()) +
                     " instead of grey (0) and " + std::to_string(metadata.image_width) + "x" +
                     std::to_string(metadata.image_height) + " px");
  }
}

void MapWriter::Implementation::add(const LocalMap& map, const cv::Mat& image) {
  const std::int64_t index = map.index;
  const Bytes png = encodeImage(image);
  const Bytes features = encodeLocalMap(map);
  broken = true;
  insert_place->bind(0, index).bind(1, map.distance_m).bind(2, map.stamp_s);
  insert_place->bind(3, std::int64_t{placeChecksum(map.index, map.distance_m, map.stamp_s)}).run();
  insert_image->bind(0, index).bind(1, png).bind(2, std::int64_t{imageChecksum(map.index, png)}).run();
  insert_state->bind(0, index)
      .bind(1, features)
      .bind(2, std::int64_t{stateChecksum(map.index, 0, features)})
      .run();
  broken = false;
  ++local_maps;
  last_distance_m = map.distance_m;
  last_stamp_s = map.stamp_s;
}

void MapWriter::Implementation::complete(const PathProfile& profile, double length_m) {
  metadata.length_m = length_m;
  broken = true;
  writeProfile(*database, profile);
  writeTraversal(*database, {0, "", metadata.taught_stamp_s, last_stamp_s, local_maps});
  writeMetadata(*database, {metadata, local_maps, profile.entries().size()});
  completeMap(*database, partial);
  broken = false;
  insert_place.reset();
  insert_image.reset();
  insert_state.reset();
  database.reset();
  partial.keep();
}

MapWriter::MapWriter(const std::string& file, const MapMetadata& metadata, bool overwrite) {
  const std::string problem = metadataProblem(metadata);
  if (!problem.empty()) {
    throw MapError("map '" + file + "': " + problem);
  }
  if (!overwrite && fileExists(file)) {
    throw MapError("map '" + file + "' exists already: choose another name, or ask for it to be overwritten");
  }
  implementation_ = std::make_unique<Implementation>(file, metadata, overwrite);
}

MapWriter::~MapWriter() = default;
MapWriter::MapWriter(MapWriter&&) noexcept = default;

void MapWriter::add(const LocalMap& map, const cv::Mat& image) {
  implementation_->check(map, image);
  implementation_->add(map, image);
}

void MapWriter::finish(const PathProfile& profile, double length_m) {
  implementation_->requireSound();
  const std::string name = "map '" + implementation_->metadata.name + "'";
  if (implementation_->local_maps == 0) {
    throw MapError(name + " has no local maps: nothing was taught");
  }
  if (!std::isfinite(length_m) || length_m < implementation_->last_distance_m) {
    throw MapError(name + ": its length, " + std::to_string(length_m) +
                   " m, is less than its last local map's distance");
  }
  if (implementation_->database) {
    implementation_->complete(profile, length_m);
  }
  implementation_->partial.publish(implementation_->overwrite);
}

std::size_t MapWriter::size() const { return implementation_->local_maps; }

}  // namespace perennial
