#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <opencv2/core.hpp>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "perennial/core/error.h"
#include "perennial/core/map_file.h"
#include "perennial/testing/temporary_folder.h"

namespace perennial {

using test_tools::TemporaryFolder;

inline MapMetadata testMetadata() {
  MapMetadata metadata;
  metadata.name = "garden";
  metadata.camera = "front";
  metadata.image_width = 12;
  metadata.image_height = 8;
  metadata.image_encoding = "mono8";
  metadata.extraction = "surf-brief/1 features=500";
  metadata.map_interval_m = 0.2;
  metadata.taught_stamp_s = 1700000000.123456789;
  return metadata;
}

/// Any bit pattern that is a finite number, denormals and -0 among them.
template <typename Float, typename Word>
Float randomFinite(std::mt19937_64& random) {
  for (;;) {
    const Word word = static_cast<Word>(random());
    Float value;
    std::memcpy(&value, &word, sizeof(value));
    if (std::isfinite(value)) {
      return value;
    }
  }
}

/// A local map of up to `most` features whose every number is random.
inline LocalMap randomLocalMap(std::uint32_t index, std::mt19937_64& random, std::size_t most = 40) {
  LocalMap map;
  map.index = index;
  map.distance_m = 0.2 * index;
  map.stamp_s = 1700000000.0 + 0.1 * index;
  map.next_id = static_cast<std::uint32_t>(random() % 1000);
  map.adopt(random() % 2 == 0 ? "score_based/1" : "", random() % 4);
  const std::size_t features = random() % (most + 1);
  for (std::size_t i = 0; i < features; ++i) {
    Keypoint keypoint;
    for (float* value : {&keypoint.x, &keypoint.y, &keypoint.scale, &keypoint.response}) {
      *value = randomFinite<float, std::uint32_t>(random);
    }
    map.add(keypoint, {{random(), random(), random(), random()}});
  }
  for (double& number : map.numbers) {
    number = randomFinite<double, std::uint64_t>(random);
  }
  for (std::size_t i = random() % 5; i > 0; --i) {
    map.map_numbers.push_back(randomFinite<double, std::uint64_t>(random));
  }
  return map;
}

inline cv::Mat randomImage(std::mt19937_64& random, int width = 12, int height = 8) {
  cv::Mat image(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random());
    }
  }
  return image;
}

template <typename Value>
bool sameBits(const std::vector<Value>& a, const std::vector<Value>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Value)) == 0);
}

inline bool sameBits(const LocalMap& a, const LocalMap& b) {
  return a.index == b.index && a.next_id == b.next_id && sameBits<double>({a.distance_m}, {b.distance_m}) &&
         sameBits<double>({a.stamp_s}, {b.stamp_s}) && a.strategy == b.strategy &&
         a.numbers_per_feature == b.numbers_per_feature &&
         sameBits(a.features.keypoints, b.features.keypoints) &&
         sameBits(a.features.descriptors, b.features.descriptors) && sameBits(a.ids, b.ids) &&
         sameBits(a.numbers, b.numbers) && sameBits(a.map_numbers, b.map_numbers);
}

inline PathProfile testProfile() {
  PathProfile profile;
  profile.add(0.0, {0.5, -0.0, 0.0});
  profile.add(1.25, {0.7, 0.1, -0.3});
  profile.add(2.0, {1e-310, -0.0, 5.0});
  return profile;
}

/// Writes a map of `local_maps` random local maps, the same for the same seed.
inline std::vector<LocalMap> writeMap(const std::string& file, std::uint32_t local_maps,
                                      std::uint64_t seed = 1, bool overwrite = false) {
  std::mt19937_64 random(seed);
  MapWriter writer(file, testMetadata(), overwrite);
  std::vector<LocalMap> maps;
  for (std::uint32_t i = 0; i < local_maps; ++i) {
    maps.push_back(randomLocalMap(i, random));
    writer.add(maps.back(), randomImage(random));
  }
  writer.finish(testProfile(), 0.2 * local_maps);
  return maps;
}

/// What an action throws, "" when it does not.
inline std::string errorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace perennial
