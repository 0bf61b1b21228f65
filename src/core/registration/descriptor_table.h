#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "perennial/core/feature.h"

namespace perennial {

/// Descriptors word by word, so that one descriptor is compared with many neighbouring ones at a time.
class DescriptorTable {
 public:
  static constexpr std::size_t kWords = Descriptor::kBits / 64;
  static constexpr std::size_t kReadBeyond = 32;

  /// Memory is kept and used again.
  void resize(std::size_t size);
  void set(std::size_t i, const Descriptor& descriptor) {
    for (std::size_t w = 0; w < kWords; ++w) {
      words_[w * stride_ + i] = descriptor.words[w];
    }
  }

  std::size_t size() const { return size_; }
  /// Word `w` of all descriptors. Up to kReadBeyond words behind the last one may be read, but mean nothing.
  const std::uint64_t* word(std::size_t w) const { return words_.data() + w * stride_; }

 private:
  std::size_t size_ = 0;
  std::size_t stride_ = 0;
  std::vector<std::uint64_t> words_;
};

/// distances[j - begin] = Hamming distance to the j-th descriptor of the table, for j = begin..end-1.
void hammingDistances(const Descriptor& descriptor, const DescriptorTable& table, std::size_t begin,
                      std::size_t end, std::uint16_t* distances) noexcept;

/// The two smallest of many distances, which may be equal.
struct SmallestTwo {
  static constexpr std::uint16_t kNone = 0xFFFF;  ///< where there are not so many

  std::uint16_t first = kNone;
  std::uint16_t second = kNone;

  void offer(std::uint16_t distance) {
    second = std::min(second, std::max(first, distance));
    first = std::min(first, distance);
  }
};

SmallestTwo smallestTwo(const std::uint16_t* distances, std::size_t count) noexcept;

}  // namespace perennial
