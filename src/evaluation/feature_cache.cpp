#include "perennial/evaluation/feature_cache.h"

#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "perennial/core/error.h"

namespace perennial {
namespace {

constexpr char kMagic[8] = {'P', 'R', 'N', 'F', 'E', 'A', 'T', '2'};

/// FNV-1a, 64 bits.
std::uint64_t fingerprint(const std::string& data, std::uint64_t hash = 14695981039346656037ULL) {
  for (const char c : data) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  }
  return hash;
}

/// What stands before the arrays. Byte order of the machine: a cache is not to be carried around.
struct Header {
  char magic[8];
  std::uint64_t features;
  std::uint64_t checksum;  ///< of the arrays
  std::int32_t image_width;
  std::int32_t image_height;
  std::int32_t edge_cell_px;
  std::int32_t edge_columns;
  std::int32_t edge_rows;
  std::int32_t unused;
  double extraction_ms;
};

template <class Array>
void append(const Array& array, std::string& data) {
  if (!array.empty()) {
    data.append(reinterpret_cast<const char*>(array.data()), array.size() * sizeof(array[0]));
  }
}

template <class Array>
void take(std::size_t count, const std::string& data, std::size_t& position, Array& array) {
  array.resize(count);
  if (count > 0) {
    std::memcpy(array.data(), data.data() + position, count * sizeof(array[0]));
  }
  position += count * sizeof(array[0]);
}

std::string arraysOf(const FeatureSet& features) {
  std::string data;
  append(features.keypoints, data);
  append(features.descriptors, data);
  append(features.edges.values, data);
  return data;
}

std::size_t edgeValues(const Header& header) {
  return 2 * static_cast<std::size_t>(header.edge_columns) * static_cast<std::size_t>(header.edge_rows);
}

FeatureSet featuresOf(const Header& header, const std::string& arrays) {
  FeatureSet features;
  std::size_t position = 0;
  take(header.features, arrays, position, features.keypoints);
  take(header.features, arrays, position, features.descriptors);
  take(edgeValues(header), arrays, position, features.edges.values);
  features.edges.cell_px = header.edge_cell_px;
  features.edges.columns = header.edge_columns;
  features.edges.rows = header.edge_rows;
  return features;
}

}  // namespace

FeatureCache::FeatureCache(std::string folder) : folder_(std::move(folder)) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) {
    throw Error("the feature cache " + folder_ + " cannot be created: " + error.message());
  }
}

std::string FeatureCache::fileFor(const std::string& image, const std::string& extraction) const {
  std::ostringstream name;
  name << std::hex << fingerprint(image) << "-" << fingerprint(extraction) << "-" << image.size()
       << ".features";
  return folder_ + "/" + name.str();
}

std::optional<CachedFeatures> FeatureCache::find(const std::string& image,
                                                 const std::string& extraction) const {
  std::ifstream stream(fileFor(image, extraction), std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();
  const std::string data = content.str();
  Header header{};
  if (data.size() < sizeof(header)) {
    return std::nullopt;
  }
  std::memcpy(&header, data.data(), sizeof(header));
  const std::string arrays = data.substr(sizeof(header));
  if (std::memcmp(header.magic, kMagic, sizeof(kMagic)) != 0 || header.checksum != fingerprint(arrays) ||
      arrays.size() != header.features * (sizeof(Keypoint) + sizeof(Descriptor)) + edgeValues(header)) {
    return std::nullopt;
  }
  auto features = std::make_shared<FeatureSet>(featuresOf(header, arrays));
  return CachedFeatures{std::move(features), header.image_width, header.image_height, header.extraction_ms};
}

void FeatureCache::store(const std::string& image, const std::string& extraction,
                         const CachedFeatures& features) const {
  static std::atomic<unsigned> counter{0};
  const std::string arrays = arraysOf(*features.features);
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof(kMagic));
  header.features = features.features->size();
  header.checksum = fingerprint(arrays);
  header.image_width = features.image_width;
  header.image_height = features.image_height;
  header.edge_cell_px = features.features->edges.cell_px;
  header.edge_columns = features.features->edges.columns;
  header.edge_rows = features.features->edges.rows;
  header.extraction_ms = features.extraction_ms;

  const std::string file = fileFor(image, extraction);
  const std::string partial = file + "." + std::to_string(getpid()) + "." + std::to_string(counter++);
  std::ofstream stream(partial, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(&header), sizeof(header));
  stream.write(arrays.data(), static_cast<std::streamsize>(arrays.size()));
  stream.close();
  if (!stream || std::rename(partial.c_str(), file.c_str()) != 0) {
    std::remove(partial.c_str());
    throw Error("the feature cache " + folder_ + " cannot be written; is the disk full?");
  }
}

std::string defaultCacheFolder() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && *cache != '\0') {
    return std::string(cache) + "/perennial_nav/features";
  }
  const char* home = std::getenv("HOME");
  return std::string(home != nullptr ? home : "/tmp") + "/.cache/perennial_nav/features";
}

}  // namespace perennial
