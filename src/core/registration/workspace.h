#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/registration/descriptor_table.h"
#include "core/registration/edge_correlation.h"
#include "core/registration/neighbour_list.h"
#include "core/registration/vote_profile.h"
#include "perennial/core/registration.h"

namespace perennial {

struct RegistrationWorkspace::Buffers {
  DescriptorTable view;
  std::vector<std::uint16_t> distances;

  // Robust registration only.
  std::vector<std::uint16_t> bounds;   ///< see offerRow()
  std::vector<std::uint32_t> by_y;     ///< view features in order of their y
  std::vector<float> sorted_y;         ///< and that y
  std::vector<NeighbourList> of_map;   ///< nearest view features of each map feature
  std::vector<NeighbourList> of_view;  ///< nearest map features of each view feature
  std::vector<Vote> votes;
  EdgeCorrelation edges;
  VoteProfile profile;
};

}  // namespace perennial
