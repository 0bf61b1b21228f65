// Maps of the reference system, to drive with. Their features are those of another extractor, which cannot be
// compared with what this one finds in the robot's images: what is imported is the taught path as if it had
// been driven now, its images, distances, times and velocities, with features of our own.
#include <algorithm>
#include <iostream>

#include "map_commands.h"
#include "perennial/core/error.h"
#include "perennial/core/feature_extractor.h"
#include "perennial/core/map_file.h"
#include "perennial/core/reference_map.h"

namespace perennial {
namespace {

std::vector<ReferenceMapFile> chosenMap(const std::string& folder, const std::string& name) {
  std::vector<ReferenceMapFile> maps;
  std::vector<std::string> names;
  for (const ReferenceMapFile& map : listReferenceMaps(folder)) {
    if (names.empty() || names.back() != map.name) {
      names.push_back(map.name);
    }
    if (name.empty() || map.name == name) {
      maps.push_back(map);
    }
  }
  std::string known;
  for (const std::string& other : names) {
    known += (known.empty() ? "" : ", ") + other;
  }
  if (maps.empty()) {
    throw DatasetError(folder + ": holds no local maps " + (name.empty() ? "<name>" : name) +
                       "_<distance>.yaml" + (known.empty() ? "" : "; its maps are: " + known));
  }
  if (name.empty() && names.size() > 1) {
    throw DatasetError(folder + ": holds several maps; say --name and one of: " + known);
  }
  return maps;
}

/// The middle one of the distances between neighbours.
double intervalOf(const std::vector<ReferenceMapFile>& maps) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < maps.size(); ++i) {
    intervals.push_back(maps[i].distance_m - maps[i - 1].distance_m);
  }
  if (intervals.empty()) {
    throw DatasetError(maps.front().file + ": is the only local map; a path has two at least");
  }
  std::sort(intervals.begin(), intervals.end());
  return intervals[intervals.size() / 2];
}

ReferenceLocalMap readWithImage(const std::string& file) {
  ReferenceLocalMap map = readReferenceMap(file);
  if (map.image.empty()) {
    throw DatasetError(
        file + ": holds no Image; its stored features cannot be compared with those of the robot's images");
  }
  return map;
}

MapMetadata metadataOf(const std::vector<ReferenceMapFile>& maps, const ReferenceLocalMap& first,
                       const std::string& encoding) {
  MapMetadata metadata;
  metadata.name = maps.front().name;
  metadata.image_width = first.image.cols;
  metadata.image_height = first.image.rows;
  metadata.image_encoding = encoding.empty() ? (first.coloured ? "bgr8" : "mono8") : encoding;
  metadata.extraction = ExtractionSettings().describe();
  metadata.map_interval_m = intervalOf(maps);
  metadata.taught_stamp_s = first.stamp_s.value_or(0.0);
  return metadata;
}

}  // namespace

void importMap(const std::string& folder, const ImportOptions& options, std::ostream& out) {
  const std::vector<ReferenceMapFile> maps = chosenMap(folder, options.name);
  const PathProfile profile = readReferenceProfile(folder + "/" + maps.front().name + ".yaml");
  const ReferenceLocalMap first = readWithImage(maps.front().file);
  const std::string file = options.file.empty() ? maps.front().name + ".perennial" : options.file;
  MapWriter writer(file, metadataOf(maps, first, options.encoding), false);
  FeatureExtractor extractor;
  for (const ReferenceMapFile& place : maps) {
    const ReferenceLocalMap stored = readWithImage(place.file);
    if (stored.image.size() != first.image.size() || stored.coloured != first.coloured) {
      throw DatasetError(place.file + ": its Image differs in size or colours from that of " +
                         maps.front().file);
    }
    LocalMap map;
    map.index = static_cast<std::uint32_t>(writer.size());
    map.distance_m = place.distance_m;
    map.stamp_s = stored.stamp_s.value_or(0.0);
    const FeatureSet features = extractor.extract(stored.image);
    for (std::size_t i = 0; i < features.size(); ++i) {
      map.add(features.keypoints[i], features.descriptors[i]);
    }
    writer.add(map, stored.image);
  }
  writer.finish(profile, std::max(maps.back().distance_m, profile.entries().back().distance_m));
  out << writer.size() << " local maps imported to '" << file << "'\n";
  if (!first.stamp_s) {
    out << "the files have no Time; the map is taken to be taught at the beginning of 1970\n";
  }
}

}  // namespace perennial
