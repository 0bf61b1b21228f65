#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "perennial/core/feature.h"
#include "perennial/core/path_profile.h"

/// Map folders of the reference system (Halodova et al., IROS 2019): one OpenCV FileStorage YAML for each
/// local map,
/// `<name>_<distance as %07.3f>.yaml`, the path profile in `<name>.yaml`, ground truth in `<name>_GT.txt`. A
/// folder may hold several maps: as a data set, each of them is a traversal. All functions throw
/// DatasetError, which names the file, and the line where there is one.
namespace perennial {

/// Where a local map is, by its file's name.
struct ReferenceMapFile {
  std::string file;  ///< with the folder
  std::string name;  ///< of the map
  double distance_m = 0.0;
};

/// A local map of the reference system.
struct ReferenceLocalMap {
  cv::Mat image;                  ///< CV_8UC1; empty where none is stored
  bool coloured = false;          ///< the stored image had colours
  FeatureSet features;            ///< as stored; descriptors shorter than 256 bits are filled up with zeros
  std::vector<double> ratings;    ///< of each feature; empty where none are stored
  std::optional<double> stamp_s;  ///< seconds since 1970
};

/// Local maps in a folder, by name, then distance. Other files are passed over.
std::vector<ReferenceMapFile> listReferenceMaps(const std::string& folder);

/// Refused: what is no FileStorage YAML; an image that is not 8-bit with 1 or 3 channels; descriptors that
/// are no bytes, as integers or as floats, or longer than 32 of them; another number of descriptors or
/// ratings than keypoints; neither image nor features.
ReferenceLocalMap readReferenceMap(const std::string& file);
/// The same from a file's content; `file` is for messages.
ReferenceLocalMap decodeReferenceMap(const std::string& content, const std::string& file);

/// The `Time` of a local map, without decoding the rest of it.
std::optional<double> readReferenceTime(const std::string& file);

/// The path profile. Refused: no `Path`, a length that is no multiple of 4, distances that fall.
PathProfile readReferenceProfile(const std::string& file);
/// The same from the content of the file, which is named in messages.
PathProfile decodeReferenceProfile(const std::string& content, const std::string& file);

/// Ground truth, one for each local map in order of distance: the first of the two integers of each line. The
/// scene lies by this much further LEFT in the image, so that the displacement x_map - x_view is that of the
/// view less that of the map.
std::vector<int> readReferenceOffsets(const std::string& file);

}  // namespace perennial
