#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace perennial {

/// The nearest few of the features that one was compared with, nearest first; equal ones by index.
class NeighbourList {
 public:
  static constexpr std::size_t kCapacity = 5;

  struct Neighbour {
    std::uint16_t distance = 0;
    std::uint32_t index = 0;
  };

  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }
  const Neighbour& operator[](std::size_t rank) const { return neighbours_[rank]; }

  /// Whether one at this distance would be taken in; most are not.
  bool admits(std::uint16_t distance) const {
    return size_ < kCapacity || distance <= neighbours_[kCapacity - 1].distance;
  }

  void offer(std::uint16_t distance, std::uint32_t index) {
    if (!admits(distance)) {
      return;
    }
    const auto before = [&](const Neighbour& other) {
      return distance < other.distance || (distance == other.distance && index < other.index);
    };
    if (size_ == kCapacity && !before(neighbours_[kCapacity - 1])) {
      return;
    }
    std::size_t place = size_ < kCapacity ? size_++ : kCapacity - 1;
    for (; place > 0 && before(neighbours_[place - 1]); --place) {
      neighbours_[place] = neighbours_[place - 1];
    }
    neighbours_[place] = {distance, index};
  }

  /// Place of a feature in the list, from 0; kCapacity when it is not there.
  std::size_t rankOf(std::uint32_t index) const {
    for (std::size_t rank = 0; rank < size_; ++rank) {
      if (neighbours_[rank].index == index) {
        return rank;
      }
    }
    return kCapacity;
  }

 private:
  std::array<Neighbour, kCapacity> neighbours_{};
  std::size_t size_ = 0;
};

}  // namespace perennial
