#include "core/registration/descriptor_table.h"

namespace perennial {

void DescriptorTable::resize(std::size_t size) {
  size_ = size;
  stride_ = size;
  words_.resize(kWords * stride_ + kReadBeyond);
}

void hammingDistances(const Descriptor& descriptor, const DescriptorTable& table, std::size_t begin,
                      std::size_t end, std::uint16_t* distances) noexcept {
  for (std::size_t j = begin; j < end; ++j) {
    int distance = 0;
    for (std::size_t w = 0; w < DescriptorTable::kWords; ++w) {
      distance += __builtin_popcountll(descriptor.words[w] ^ table.word(w)[j]);
    }
    distances[j - begin] = static_cast<std::uint16_t>(distance);
  }
}

SmallestTwo smallestTwo(const std::uint16_t* distances, std::size_t count) noexcept {
  SmallestTwo smallest;
  for (std::size_t i = 0; i < count; ++i) {
    if (distances[i] < smallest.second) {  // seldom
      smallest.offer(distances[i]);
    }
  }
  return smallest;
}

}  // namespace perennial
