#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace perennial {

/// The nearest few of the features that one was compared with, nearest first; equal ones by index.
class NeighbourList {
 public:
  static constexpr std::size_t kCapacity = 5;
  /// More than any distance: the bound of a list that has room.
  static constexpr std::uint16_t kNoBound = 0xFFFF;

  struct Neighbour {
    std::uint16_t distance = 0;
    std::uint32_t index = 0;
  };

  NeighbourList() { clear(); }
  void clear() { keys_.fill(kNone); }
  std::size_t size() const {
    return static_cast<std::size_t>(std::find(keys_.begin(), keys_.end(), kNone) - keys_.begin());
  }
  Neighbour operator[](std::size_t rank) const {
    return {static_cast<std::uint16_t>(keys_[rank] >> 32), static_cast<std::uint32_t>(keys_[rank])};
  }

  /// Whoever is offered after all of lower index is taken in if its distance is below this.
  std::uint16_t bound() const { return static_cast<std::uint16_t>(keys_.back() >> 32); }

  /// Without a branch: who comes is as good as random.
  void offer(std::uint16_t distance, std::uint32_t index) {
    const std::uint64_t key = std::uint64_t{distance} << 32 | index;
    for (std::size_t place = kCapacity - 1; place > 0; --place) {
      keys_[place] = std::min(keys_[place], std::max(keys_[place - 1], key));
    }
    keys_[0] = std::min(keys_[0], key);
  }

  /// Place of a feature in the list, from 0; kCapacity when it is not there.
  std::size_t rankOf(std::uint32_t index) const {
    for (std::size_t rank = 0; rank < kCapacity && keys_[rank] != kNone; ++rank) {
      if (static_cast<std::uint32_t>(keys_[rank]) == index) {
        return rank;
      }
    }
    return kCapacity;
  }

 private:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};

  std::array<std::uint64_t, kCapacity> keys_;  ///< distance above index, ascending
};

/// One map feature and the view features it is compared with, by their place in a row.
struct OfferedRow {
  const std::uint16_t* distances;  ///< to each of them
  std::size_t count;
  std::uint32_t index;                ///< of the map feature
  const std::uint32_t* view_indices;  ///< of each view feature
};

/// So many elements behind a row of distances and of bounds must be there to be read.
constexpr std::size_t kOfferBeyond = 64;

/// Offers the row's view features to the map feature's list, and the map feature to theirs, of_view[view
/// index]. `bounds` holds the bound of each of the latter, by place, and is kept so. Map features must come
/// by ascending index. Behind the row's distances there must be kOfferBeyond of NeighbourList::kNoBound.
void offerRow(const OfferedRow& row, NeighbourList& of_map, NeighbourList* of_view,
              std::uint16_t* bounds) noexcept;

}  // namespace perennial
