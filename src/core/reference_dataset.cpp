// Map folders of the reference system as a data set.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include "perennial/core/dataset.h"
#include "perennial/core/error.h"
#include "perennial/core/reference_map.h"

namespace perennial {
namespace {

constexpr double kNoTimeStart_s = 946684800.0;  // 2000-01-01T00:00:00Z
constexpr double kDay_s = 86400.0;

/// One map of the folder.
struct Traversal {
  std::string name;
  std::vector<ReferenceMapFile> maps;  ///< by distance
  std::vector<std::optional<double>> stamps_s;
};

std::vector<Traversal> traversalsIn(const std::string& folder) {
  std::vector<Traversal> traversals;
  for (const ReferenceMapFile& map : listReferenceMaps(folder)) {
    if (traversals.empty() || traversals.back().name != map.name) {
      traversals.push_back({map.name, {}, {}});
    }
    traversals.back().maps.push_back(map);
    traversals.back().stamps_s.push_back(readReferenceTime(map.file));
  }
  if (traversals.empty()) {
    throw DatasetError(folder + ": holds no maps named <name>_<distance>.yaml");
  }
  return traversals;
}

/// True when all files have a time, false when none has.
bool haveTimes(const std::vector<Traversal>& traversals) {
  const bool first = traversals.front().stamps_s.front().has_value();
  for (const Traversal& traversal : traversals) {
    for (std::size_t i = 0; i < traversal.maps.size(); ++i) {
      if (traversal.stamps_s[i].has_value() != first) {
        throw DatasetError(traversal.maps[i].file + ": has " + (first ? "no" : "a") + " Time, but " +
                           traversals.front().maps.front().file + " has " + (first ? "one" : "none"));
      }
    }
  }
  return first;
}

void bringIntoOrder(std::vector<Traversal>& traversals) {
  if (!haveTimes(traversals)) {
    for (std::size_t t = 0; t < traversals.size(); ++t) {
      traversals[t].stamps_s.assign(traversals[t].maps.size(),
                                    kNoTimeStart_s + kDay_s * static_cast<double>(t));
    }
    return;
  }
  const auto earlier = [](const Traversal& a, const Traversal& b) {
    return a.stamps_s.front() < b.stamps_s.front();
  };
  if (std::is_sorted(traversals.begin(), traversals.end(), earlier)) {
    return;
  }
  std::stable_sort(traversals.begin(), traversals.end(), earlier);
  const std::size_t digits = std::to_string(traversals.size()).size();
  for (std::size_t t = 0; t < traversals.size(); ++t) {
    const std::string number = std::to_string(t);
    traversals[t].name = std::string(digits - number.size(), '0') + number + "_" + traversals[t].name;
  }
}

/// Half the way to the nearest other place.
double reachOf(const std::vector<ReferenceMapFile>& places, std::size_t i) {
  double reach = std::numeric_limits<double>::infinity();
  if (i > 0) {
    reach = 0.5 * (places[i].distance_m - places[i - 1].distance_m);
  }
  if (i + 1 < places.size()) {
    reach = std::min(reach, 0.5 * (places[i + 1].distance_m - places[i].distance_m));
  }
  return reach;
}

void requireSamePlaces(const Traversal& traversal, const Traversal& first) {
  if (traversal.maps.size() != first.maps.size()) {
    throw DatasetError(traversal.maps.front().file + ": its map has " +
                       std::to_string(traversal.maps.size()) + " local maps, but " + first.maps.front().file +
                       " belongs to one of " + std::to_string(first.maps.size()));
  }
  for (std::size_t i = 0; i < first.maps.size(); ++i) {
    if (std::abs(traversal.maps[i].distance_m - first.maps[i].distance_m) >= reachOf(first.maps, i)) {
      throw DatasetError(traversal.maps[i].file + ": is nearer to another place than to that of " +
                         first.maps[i].file);
    }
  }
}

std::vector<int> offsetsOf(const Traversal& traversal, const std::string& folder,
                           const std::string& map_name) {
  const std::string file = folder + "/" + map_name + "_GT.txt";
  std::vector<int> offsets = readReferenceOffsets(file);
  if (offsets.size() != traversal.maps.size()) {
    throw DatasetError(file + ":" + std::to_string(offsets.size()) + ": is the last of " +
                       std::to_string(offsets.size()) + " lines, but there are " +
                       std::to_string(traversal.maps.size()) + " local maps");
  }
  return offsets;
}

}  // namespace

Dataset loadReferenceDataset(const std::string& folder) {
  std::vector<Traversal> traversals = traversalsIn(folder);
  bringIntoOrder(traversals);
  Dataset dataset;
  dataset.manifest = folder;
  for (const Traversal& traversal : traversals) {
    requireSamePlaces(traversal, traversals.front());
    const std::vector<int> offsets = offsetsOf(traversal, folder, traversal.maps.front().name);
    for (std::size_t i = 0; i < traversal.maps.size(); ++i) {
      DatasetRow row;
      row.traversal = traversal.name;
      row.stamp_s = *traversal.stamps_s[i];
      row.distance_m = traversals.front().maps[i].distance_m;
      row.image = traversal.maps[i].file;
      row.offset_px = -offsets[i];
      dataset.rows.push_back(row);
    }
  }
  sortAndCheck(dataset);
  return dataset;
}

}  // namespace perennial
