#pragma once

#include <cstdint>
#include <vector>

#include "perennial/park/loop_path.h"

namespace perennial::park {

enum class PlantKind { kBroadleaf, kConifer, kShrub };

struct Plant {
  PlantKind kind = PlantKind::kBroadleaf;
  double x = 0.0, y = 0.0;  ///< m
  double height_m = 8.0;
  double crown_radius_m = 2.5;
  int detail = 2;  ///< 2 beside the path, 1 further off, 0 in the background
  std::int64_t seed = 0;
};

enum class ObjectKind { kBench, kBin, kLamp, kSign, kBicycle, kCrate, kTent, kCart, kPicnicTable, kHouse };

struct Object {
  ObjectKind kind = ObjectKind::kBench;
  Pose pose;
  std::int64_t seed = 0;
};

/// What stands where in the park. Plants and furniture stay where they are for all years; see thingsOfDay()
/// for what comes and goes. Nothing stands within 1.2 m of the path.
struct ParkLayout {
  std::vector<Plant> plants;
  std::vector<Object> furniture;  ///< benches, bins, lamps, signs and the house
  std::vector<Pose> spots;        ///< places where people leave things
};

/// The same seed and loop give the same park.
ParkLayout makeLayout(const LoopPath& path, int seed);

/// What people have left in the park on this day; each spot changes every one to ten days.
std::vector<Object> thingsOfDay(const ParkLayout& layout, int seed, std::int64_t day);

}  // namespace perennial::park
