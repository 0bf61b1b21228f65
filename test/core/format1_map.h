#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>

#include "map_test_support.h"

namespace perennial {

/// test/data/format1.perennial and what it holds. It was written by the last program of format version 1,
/// with these same random numbers: five local maps, and two traversals that changed two of them each. It was
/// taught comparing intensities, which the text of its extraction does not say.
struct Format1Map {
  static constexpr std::uint32_t kLocalMaps = 5;
  static constexpr std::uint32_t kTraversals = 2;

  Format1Map() {
    std::mt19937_64 random(20260101);
    states.resize(kTraversals + 1);
    for (std::uint32_t i = 0; i < kLocalMaps; ++i) {
      states[0].push_back(randomLocalMap(i, random, 8));
      images.push_back(randomImage(random));
    }
    for (std::uint32_t traversal = 1; traversal <= kTraversals; ++traversal) {
      states[traversal] = states[traversal - 1];
      for (std::uint32_t i = traversal; i < kLocalMaps; i += 2) {
        states[traversal][i] = randomLocalMap(i, random, 8);
      }
    }
  }

  /// "" when the file holds exactly this, up to traversal 2; else the first difference.
  std::string differenceFrom(const std::string& file) const;

  std::vector<std::vector<LocalMap>> states;  ///< by traversal, by local map
  std::vector<cv::Mat> images;
};

inline std::vector<char> bytesOf(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return std::vector<char>(std::istreambuf_iterator<char>(stream), {});
}

inline bool sameBits(const PathProfile& a, const PathProfile& b) {
  const auto numbers = [](const PathProfile& profile) {
    std::vector<double> all;
    for (const ProfileEntry& entry : profile.entries()) {
      const Velocity& velocity = entry.velocity;
      all.insert(all.end(), {entry.distance_m, velocity.forward, velocity.angular, velocity.flipper});
    }
    return all;
  };
  return sameBits(numbers(a), numbers(b));
}

inline std::string Format1Map::differenceFrom(const std::string& file) const {
  const MapFile map(file);
  const MapMetadata& metadata = map.metadata();
  const MapMetadata taught = testMetadata();
  if (metadata.name != taught.name || metadata.camera != taught.camera ||
      metadata.image_width != taught.image_width || metadata.image_height != taught.image_height ||
      metadata.image_encoding != taught.image_encoding ||
      !sameBits<double>({metadata.map_interval_m, metadata.taught_stamp_s, metadata.length_m},
                        {taught.map_interval_m, taught.taught_stamp_s, 1.1})) {
    return "metadata";
  }
  if (!sameBits(map.profile(), testProfile())) {
    return "profile";
  }
  const std::vector<TraversalInfo> traversals = map.traversals();
  if (traversals.size() < kTraversals + 1 || map.size() != kLocalMaps) {
    return "number of traversals or local maps";
  }
  for (std::uint32_t t = 0; t <= kTraversals; ++t) {
    const bool taught_then = t == 0;
    const double start_s = taught_then ? taught.taught_stamp_s : 1700000000.0 + 1000.0 * t;
    const double end_s = taught_then ? 1700000000.0 + 0.1 * (kLocalMaps - 1) : start_s + 60.5;
    if (traversals[t].strategy != (taught_then ? "" : "latest/1") ||
        !sameBits<double>({traversals[t].start_stamp_s, traversals[t].end_stamp_s}, {start_s, end_s}) ||
        traversals[t].updated_maps != (taught_then ? kLocalMaps : 2)) {
      return "traversal " + std::to_string(t);
    }
    for (std::uint32_t i = 0; i < kLocalMaps; ++i) {
      if (!sameBits(map.readAt(i, t), states[t][i])) {
        return "local map " + std::to_string(i) + " after traversal " + std::to_string(t);
      }
    }
  }
  for (std::uint32_t i = 0; i < kLocalMaps; ++i) {
    if (cv::norm(map.readImage(i), images[i], cv::NORM_INF) != 0.0) {
      return "image " + std::to_string(i);
    }
  }
  const std::vector<std::string> problems = map.verify();
  return problems.empty() ? "" : problems.front();
}

}  // namespace perennial
