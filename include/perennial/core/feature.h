#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "perennial/core/edge_field.h"

namespace perennial {

/// An interest point of an image. Coordinates are in pixels of the full image, origin at the centre of the
/// top left pixel, x to the right, y down.
struct Keypoint {
  float x = 0.0F;
  float y = 0.0F;
  float scale = 0.0F;     ///< standard deviation of the Gaussian the box filter approximates, px
  float response = 0.0F;  ///< determinant of the Hessian of intensities in [0, 1], normalised for scale

  bool operator==(const Keypoint& other) const {
    return x == other.x && y == other.y && scale == other.scale && response == other.response;
  }
};

/// 256-bit binary descriptor. Bit i of the sampling pattern is bit (i % 64) of word (i / 64).
struct Descriptor {
  static constexpr std::size_t kBits = 256;
  static constexpr std::size_t kBytes = kBits / 8;

  std::array<std::uint64_t, kBits / 64> words{};

  bool operator==(const Descriptor& other) const { return words == other.words; }
};

/// Number of bits in which two descriptors differ, 0..256.
inline int hammingDistance(const Descriptor& a, const Descriptor& b) noexcept {
  int distance = 0;
  for (std::size_t i = 0; i < a.words.size(); ++i) {
    distance += __builtin_popcountll(a.words[i] ^ b.words[i]);
  }
  return distance;
}

/// Features of one image or local map: two arrays of the same length, and what else of the image serves to
/// register it.
struct FeatureSet {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  /// Of the whole image: not among what a strategy adds and drops, and computed anew from the taught image
  /// where a map comes from a file. Empty: registration does without. Not compared.
  EdgeField edges;

  std::size_t size() const { return keypoints.size(); }
  bool empty() const { return keypoints.empty(); }
  void clear() {
    keypoints.clear();
    descriptors.clear();
    edges.clear();
  }
  void reserve(std::size_t capacity) {
    keypoints.reserve(capacity);
    descriptors.reserve(capacity);
  }
  void add(const Keypoint& keypoint, const Descriptor& descriptor) {
    keypoints.push_back(keypoint);
    descriptors.push_back(descriptor);
  }
  bool operator==(const FeatureSet& other) const {
    return keypoints == other.keypoints && descriptors == other.descriptors;
  }
};

}  // namespace perennial
