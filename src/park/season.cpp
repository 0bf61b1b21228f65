#include "perennial/park/season.h"

#include <algorithm>
#include <cmath>

#include "perennial/park/random.h"

namespace perennial::park {
namespace {

/// Rises smoothly from 0 at `start` to 1 at `end`.
double rise(double value, double start, double end) {
  const double t = std::clamp((value - start) / (end - start), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Grass grows from April to October and is mown every three weeks.
double grassHeight(double day_of_year) {
  constexpr double kMowingPeriodDays = 21.0;
  const double growing = rise(day_of_year, 85.0, 120.0) * (1.0 - rise(day_of_year, 275.0, 305.0));
  return 0.04 + 0.12 * growing * std::fmod(day_of_year, kMowingPeriodDays) / kMowingPeriodDays;
}

/// Snow lies whenever it snows, and in about half of the weeks of winter, thickest in January.
double snowCover(const Conditions& conditions, double day_of_year) {
  if (conditions.weather == Weather::kSnow) {
    return 0.92;
  }
  const double cold = rise(day_of_year, 330.0, 365.0) + 1.0 - rise(day_of_year, 40.0, 70.0);
  Random random(mix({conditions.world_seed, conditions.day() / 7, 77}));
  const double fallen = random.uniform();
  return conditions.weather == Weather::kRain || fallen < 0.5 ? 0.0
                                                              : std::min(1.0, cold) * (0.4 + fallen * 0.55);
}

}  // namespace

Season seasonOf(const Conditions& conditions) {
  const double day = std::floor(dayOfYear(conditions.date_time_s));
  Season season;
  season.leaf_density = rise(day, 98.0, 138.0) * (1.0 - rise(day, 285.0, 322.0));
  season.bud_freshness = 1.0 - rise(day, 115.0, 165.0);
  season.leaf_turned = rise(day, 255.0, 305.0);
  // What fell in autumn rots until spring.
  season.litter = day > 200.0 ? rise(day, 275.0, 318.0) : 0.7 * (1.0 - rise(day, 20.0, 110.0));
  season.grass_height_m = grassHeight(day);
  season.grass_dryness = std::max(0.7 * (1.0 - rise(day, 80.0, 115.0)), 0.6 * rise(day, 300.0, 345.0)) +
                         0.3 * rise(day, 195.0, 215.0) * (1.0 - rise(day, 240.0, 265.0));
  season.snow_cover = snowCover(conditions, day);
  return season;
}

}  // namespace perennial::park
