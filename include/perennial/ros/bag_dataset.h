#pragma once

#include <string>
#include <vector>

#include "perennial/core/dataset.h"

namespace perennial {

/// What was seen when, without the images: these are in a bag.
///
/// A table with the columns traversal, stamp (of the image's header, ISO 8601, UTC), distance_m, offset_px,
/// as in a data set's manifest. Rows stand in the order of the file, without an image. Throws DatasetError
/// naming file and line.
std::vector<DatasetRow> loadGroundTruth(const std::string& file);

/// Makes a data set of bags: the images that `ground_truth` names by their stamps, as PNG, and a
/// manifest.csv. Images are made grey as the nodes do it. A row without an image of its time (to 0.1 ms) is
/// left out and said so in `problems` ("FILE:LINE: what is wrong"). Throws DatasetError for a malformed
/// table, Error for a bag that cannot be read, lacks the topic or holds something else there, and for a
/// folder that cannot be written.
void writeBagDataset(const std::vector<std::string>& bags, const std::string& image_topic,
                     const std::string& ground_truth, const std::string& folder,
                     std::vector<std::string>& problems);

}  // namespace perennial
