#include "core/registration/neighbour_list.h"

namespace perennial {

void offerRow(const OfferedRow& row, NeighbourList& of_map, NeighbourList* of_view,
              std::uint16_t* bounds) noexcept {
  for (std::size_t place = 0; place < row.count; ++place) {
    const std::uint16_t distance = row.distances[place];
    const std::uint32_t index = row.view_indices[place];
    if (distance <= of_map.bound()) {  // seldom, and the next test, too
      of_map.offer(distance, index);
    }
    if (distance < bounds[place]) {
      of_view[index].offer(distance, row.index);
      bounds[place] = of_view[index].bound();
    }
  }
}

}  // namespace perennial
