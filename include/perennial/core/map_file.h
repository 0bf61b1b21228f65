#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "perennial/core/local_map.h"
#include "perennial/core/path_profile.h"

namespace perennial {

/// What is known of a map as a whole.
struct MapMetadata {
  std::string name;
  std::string camera;    ///< name of the camera (or its frame) it was taught with
  int image_width = 0;   ///< px
  int image_height = 0;  ///< px
  std::string
      image_encoding;      ///< as in sensor_msgs/Image: "mono8", "bgr8"; the map itself stores grey images
  std::string extraction;  ///< ExtractionSettings::describe() of the teaching
  double map_interval_m = 0.0;
  double taught_stamp_s = 0.0;  ///< stamp of the first image, seconds since 1970
  double length_m = 0.0;        ///< length of the taught path; at least the last local map's distance
};

/// Throws MapError, with both settings and what to do, unless the map was taught with `wanted`
/// (ExtractionSettings::describe()): features of other settings cannot be matched.
void requireSameExtraction(const MapMetadata& metadata, const std::string& wanted);

/// One traversal that the map has learned from. Traversal 0 is the teaching.
struct TraversalInfo {
  std::uint32_t id = 0;
  std::string strategy;  ///< "score_based/1"; empty for the teaching
  double start_stamp_s = 0.0;
  double end_stamp_s = 0.0;
  std::size_t updated_maps = 0;
};

/// Where a local map is, without its features.
struct LocalMapPlace {
  std::uint32_t index = 0;
  double distance_m = 0.0;
};

/// Where the original of a map is kept, beside it, when it is migrated from this version of the format. No
/// map by its name.
std::string keptMapFile(const std::string& file, std::uint32_t format_version);

/// What takes how much room in a map file.
struct MapSizes {
  std::uint64_t file_bytes = 0;
  std::uint64_t unused_bytes = 0;  ///< within the file, after a rollback; used by later traversals
  std::uint64_t image_bytes = 0;
  std::uint64_t taught_bytes = 0;   ///< features as they were taught
  std::uint64_t learned_bytes = 0;  ///< states of later traversals
};

/// Writes a newly taught map. Everything goes to `<file>.partial`; only finish() makes `<file>` appear,
/// complete and in one step, so that a half-taught map is never taken for a whole one. A partial file that a
/// crash left behind is replaced; one that is being written at this moment is refused. Memory does not grow
/// with the path. One thread. Throws MapError.
class MapWriter {
 public:
  /// Creates missing folders. Refuses an existing `file` unless `overwrite`; the old one stays until
  /// finish().
  MapWriter(const std::string& file, const MapMetadata& metadata, bool overwrite);
  /// Without finish(): removes the partial file.
  ~MapWriter();
  MapWriter(MapWriter&&) noexcept;
  MapWriter& operator=(MapWriter&&) = delete;

  /// `map.index` must be the number of maps added before, distances must not fall. `image`: CV_8UC1 of the
  /// metadata's size, stored as PNG; anything else is an ImageError.
  void add(const LocalMap& map, const cv::Mat& image);

  /// Stores the profile and the length, syncs, and renames to the final name. A map without local maps is
  /// refused. When only the name cannot be given (it is taken meanwhile, or the map to be replaced is in
  /// use), the complete map stays in the partial file, the error says so, and finish() may be called again;
  /// not after a sync that failed, for nobody knows then what is on the disk.
  void finish(const PathProfile& profile, double length_m);

  std::size_t size() const;  ///< local maps added

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// A taught map: one SQLite file. Local maps are read when asked for, never all at once; opening does not
/// depend on the length of the path. Every blob carries a checksum, tested on reading.
///
/// Changes are staged by a traversal and appear in one transaction, commitTraversal(). States of earlier
/// traversals are kept, the taught state always. One thread at a time. Any number of programs may read one
/// file; one may have a traversal open, which is an SQLite RESERVED lock on the file: the second is refused,
/// readers go on, and the lock goes with its process.
///
/// A map of an older format version is read as it is. What writes to it (beginTraversal(), rollback(),
/// compact()) first puts a copy in the present format in its place and keeps the original as keptMapFile();
/// where that fails, MigrationError, and the map is as it was.
///
/// Throws MapError, with the file's name and what to do, for a file that is missing, no map, damaged, or of a
/// newer format version.
class MapFile {
 public:
  explicit MapFile(const std::string& file);
  ~MapFile();
  MapFile(MapFile&&) noexcept;
  MapFile& operator=(MapFile&&) noexcept;

  const std::string& file() const;
  const MapMetadata& metadata() const;
  const PathProfile& profile() const;
  std::size_t size() const;  ///< number of local maps
  std::uint32_t formatVersion() const;

  /// Local map `index`, in its newest committed or staged state; or in the committed state after `traversal`.
  LocalMap read(std::uint32_t index) const;
  LocalMap readAt(std::uint32_t index, std::uint32_t traversal) const;
  /// The taught image, decoded (CV_8UC1), or as the stored PNG.
  cv::Mat readImage(std::uint32_t index) const;
  std::vector<std::uint8_t> readImagePng(std::uint32_t index) const;

  /// Local maps with from_m <= distance <= to_m, in order.
  std::vector<LocalMapPlace> between(double from_m, double to_m) const;
  /// The local map nearest in distance; of two equally near the earlier one.
  LocalMapPlace nearest(double distance_m) const;

  /// Traversals in order; the first is the teaching.
  std::vector<TraversalInfo> traversals() const;

  /// Opens a traversal: what is staged from now on belongs to it. Returns its id. An error when one is open
  /// already, here or in another program, and where the file cannot be written.
  std::uint32_t beginTraversal(const std::string& strategy, double start_stamp_s);
  /// New state of a local map; replaces an earlier one staged for it. read() sees it at once, the file does
  /// not. Index, distance and stamp must be those of the taught one. Staged states wait on disk, not in
  /// memory.
  void stage(const LocalMap& map);
  /// All of the traversal or nothing. Without anything staged, no traversal is recorded. After an error (disk
  /// full) the file is as it was and the traversal still open: commit again, or discard it. Only when nothing
  /// but the folder could not be synced it is committed, and the error says so.
  void commitTraversal(double end_stamp_s);
  void discardTraversal();

  /// Forgets every traversal after `traversal`. Not while a traversal is open.
  void rollback(std::uint32_t traversal);

  /// Bounds the file's size: writes it anew with the newest `keep` traversals one by one, and all earlier
  /// ones merged into a single traversal, number 1. Newest and taught states stay what they are; rollback
  /// reaches the merged traversal, the kept ones and the teaching. The old file is replaced in one step.
  /// Needs room for the new one meanwhile. Not while a traversal is open, here or in another program.
  void compact(std::uint32_t keep);

  MapSizes sizes() const;

  /// Reads everything and returns what is wrong, empty when nothing is.
  std::vector<std::string> verify() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace perennial
