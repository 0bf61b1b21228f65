#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "core/map/local_map_codec.h"
#include "core/map/sqlite.h"
#include "perennial/core/map_file.h"

namespace perennial {

/// The image as PNG. Throws ImageError.
Bytes encodeImage(const cv::Mat& image);

/// Taught image of a local map: CV_8UC1 of the metadata's size. Throws MapError for anything else.
cv::Mat readImage(const Database& database, std::uint32_t local_map, const MapMetadata& metadata);

}  // namespace perennial
