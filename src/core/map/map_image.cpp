#include "core/map/map_image.h"

#include <cstddef>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "core/map/map_rows.h"

namespace perennial {
namespace {

constexpr std::size_t kWidthAt = 16;  // in the chunk IHDR, which begins every PNG
constexpr std::size_t kHeightAt = 20;

std::int64_t bigEndian(const Bytes& bytes, std::size_t at) {
  return std::int64_t{bytes[at]} << 24 | std::int64_t{bytes[at + 1]} << 16 |
         std::int64_t{bytes[at + 2]} << 8 | std::int64_t{bytes[at + 3]};
}

/// Looked at before decoding, which would allocate whatever size the file claims.
bool hasSize(const Bytes& png, const MapMetadata& metadata) {
  return png.size() >= kHeightAt + 4 && bigEndian(png, kWidthAt) == metadata.image_width &&
         bigEndian(png, kHeightAt) == metadata.image_height;
}

}  // namespace

Bytes encodeImage(const cv::Mat& image) {
  Bytes png;
  if (!cv::imencode(".png", image, png)) {
    throw ImageError("OpenCV makes no PNG of an image");
  }
  return png;
}

cv::Mat readImage(const Database& database, std::uint32_t local_map, const MapMetadata& metadata) {
  const Bytes png = readPng(database, local_map);
  cv::Mat image;
  if (hasSize(png, metadata)) {
    try {
      image = cv::imdecode(png, cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception&) {
      image.release();  // refused below, like a PNG that decodes to nothing
    }
  }
  if (image.type() != CV_8UC1 || image.cols != metadata.image_width || image.rows != metadata.image_height) {
    throwDamaged(database.file(), "the image of local map " + std::to_string(local_map) +
                                      " is no grey PNG of " + std::to_string(metadata.image_width) + "x" +
                                      std::to_string(metadata.image_height) + " px");
  }
  return image;
}

}  // namespace perennial
