#pragma once

#include <cstddef>
#include <vector>

#include "perennial/core/local_map.h"
#include "perennial/core/map_strategy.h"

/// Steps that map strategies are made of.
namespace perennial {

/// View features that no map feature is paired with, those least like anything in the map first: ordered by falling
/// Hamming distance to their nearest feature of the local map (all its features, used or not), equal ones by index.
std::vector<std::size_t> newFeatures(const LocalMap& map, const Observation& observation);

/// Adds these features of the view to the map, in the map's frame: at x_view + displacement. The observation's
/// registration must have a displacement.
void insertFromView(LocalMap& map, const Observation& observation, const std::vector<std::size_t>& view_indices);

}  // namespace perennial
