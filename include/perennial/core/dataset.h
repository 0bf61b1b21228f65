#pragma once

#include <cstddef>
#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "perennial/core/csv.h"

namespace perennial {

/// One image of a data set: what a traversal saw at a place.
struct DatasetRow {
  std::string traversal;    ///< name of the run; names sort in time order within a place
  double stamp_s = 0.0;     ///< when it was taken, seconds since 1970
  double distance_m = 0.0;  ///< the place on the path
  std::string image;        ///< file, with the data set's folder
  double offset_px =
      0.0;  ///< horizontal position of the scene in the image, relative to a reference of the place
  std::size_t line = 0;  ///< line of the manifest, from 1; 0: there is no manifest
};

/// Images of the same places across time, with ground truth. A place is identified by its distance; image
/// size and time order belong to a place, since places may come from different cameras.
struct Dataset {
  std::string manifest;          ///< file, for messages; without a manifest the folder
  std::vector<DatasetRow> rows;  ///< by traversal name, then distance

  /// Names of the traversals, sorted.
  std::vector<std::string> traversals() const;

  /// The images of one traversal, by distance. Throws DatasetError naming the traversals there are for an
  /// unknown one.
  std::vector<DatasetRow> traversal(const std::string& name) const;

  /// The images of each place, in order of the traversals' names, keyed by distance.
  std::map<double, std::vector<DatasetRow>> places() const;

  /// The image of a row, CV_8UC1. Throws DatasetError naming manifest, line and image when it cannot be read.
  cv::Mat readImage(const DatasetRow& row) const;
  /// The same from the content of its file.
  cv::Mat decodeImage(const DatasetRow& row, const std::string& content) const;
  /// The content of the row's file. Throws DatasetError likewise.
  std::string readFile(const DatasetRow& row) const;

  /// Where a row comes from, to begin a message with: "MANIFEST:LINE: "; "FILE: " for one without a manifest.
  std::string at(const DatasetRow& row) const;
};

/// Displacement x_map - x_view between an image taken as the map and one of the same place taken as the view.
inline double groundTruthDisplacement(const DatasetRow& map, const DatasetRow& view) {
  return map.offset_px - view.offset_px;
}

/// Brings the rows into their order and throws DatasetError for a place listed twice in a traversal and for
/// time that goes backwards within a place.
void sortAndCheck(Dataset& dataset);

/// Reads `folder`/manifest.csv with the columns traversal, stamp (ISO 8601, UTC), distance_m, image (relative
/// to the folder), offset_px, in any order; others are ignored. Throws DatasetError naming file and line for:
/// a missing column or file, a field that is no number or time, a distance that is negative or beyond 1000
/// km, a place listed twice in a traversal, time that goes backwards within a place, no rows. Images are not
/// opened.
///
/// A folder without a manifest may hold maps of the reference system (reference_map.h), see
/// loadReferenceDataset().
Dataset loadDataset(const std::string& folder);

/// The same from the manifest of `folder`, which has been read already.
Dataset datasetOf(const CsvTable& manifest, const std::string& folder);

/// Map folders of the reference system as a data set: each map is a traversal, local maps of the same rank
/// belong to the same place, at the distance that the first traversal has for it. Where the files have a
/// `Time`, traversals are in the order of the times of their first local maps, and numbered ("003_name")
/// unless their names sort so already; else they are in order of their names and taken as a day apart, the
/// first on 2000-01-01. `offset_px` is the negative of the ground truth, for that counts to the left.
///
/// Throws DatasetError naming the file, and the line where there is one: a traversal without ground truth, or
/// with another number of lines than local maps; another number of local maps than in the first traversal, or
/// one half an interval or more away from the place of its rank; a `Time` in some files only; time that goes
/// backwards at a place; no maps.
Dataset loadReferenceDataset(const std::string& folder);

}  // namespace perennial
