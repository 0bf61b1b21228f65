#pragma once

#include "perennial/park/conditions.h"

namespace perennial::park {

/// What the time of the year does to the park, at 50 degrees north. All of it depends on the day only (and on
/// whether it snows), so that one traversal sees one state.
struct Season {
  double leaf_density = 1.0;   ///< [0, 1]; of broad-leaved trees: 0 bare, 1 full
  double bud_freshness = 0.0;  ///< [0, 1]; 1: the light green of the first leaves
  double leaf_turned = 0.0;    ///< [0, 1]; share of yellow, red and brown leaves
  double litter = 0.0;         ///< [0, 1]; share of the ground under trees that fallen leaves cover
  double grass_height_m = 0.1;
  double grass_dryness = 0.0;  ///< [0, 1]; 1: straw-coloured
  double snow_cover = 0.0;     ///< [0, 1]; share of the ground under snow
};

Season seasonOf(const Conditions& conditions);

}  // namespace perennial::park
