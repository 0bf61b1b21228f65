#include "perennial/park/conditions.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "perennial/core/error.h"
#include "perennial/park/conditions_yaml.h"
#include "perennial/park/lighting.h"
#include "perennial/park/season.h"
#include "perennial/park/sun_position.h"

namespace perennial::park {
namespace {

constexpr double kDegPerRad = 57.29577951308232;

Conditions on(const std::string& date_time) {
  Conditions conditions;
  conditions.date_time_s = parseDateTime(date_time);
  return conditions;
}

TEST(Conditions, parsesIso8601) {
  EXPECT_EQ(parseDateTime("1970-01-01T00:00:00Z"), 0.0);
  EXPECT_EQ(parseDateTime("2026-06-21T11:00:00Z"), 1782039600.0);
  EXPECT_EQ(parseDateTime("2026-06-21T11:00:00.25Z"), 1782039600.25);
}

TEST(Conditions, refusesDatesThatDoNotExist) {
  for (const char* text : {"2026-02-30T11:00:00Z", "2026-06-21", "noon", "2026-13-01T11:00:00Z",
                           "1969-12-31T23:59:59Z", "2026-06-21T25:00:00Z", "2026-06-21T11:00:61Z"}) {
    EXPECT_THROW(parseDateTime(text), ParameterError) << text;
  }
}

TEST(Conditions, loadKeepsWhatIsNotGiven) {
  Conditions base = on("2026-01-02T03:04:05Z");
  base.wind_m_s = 7.0;
  ParameterReader reader({{"weather", std::string("rain")}, {"searchlight", std::string("off")}});
  const Conditions changed = Conditions::load(reader, base);
  EXPECT_NO_THROW(reader.requireAllUsed());
  EXPECT_EQ(changed.weather, Weather::kRain);
  EXPECT_EQ(changed.searchlight, Searchlight::kOff);
  EXPECT_EQ(changed.date_time_s, base.date_time_s);
  EXPECT_EQ(changed.wind_m_s, 7.0);
  ParameterReader wrong({{"wind_m_s", 31.0}});
  EXPECT_THROW(Conditions::load(wrong, base), ParameterError);
}

TEST(Conditions, yamlChangesWhatItNames) {
  Conditions base;
  base.wind_m_s = 7.0;
  const Conditions changed = mergedConditions(
      base, "{date_time: '2026-01-15T11:00:00Z', weather: snow, searchlight: on, world_seed: 3}");
  EXPECT_EQ(changed.date_time_s, parseDateTime("2026-01-15T11:00:00Z"));
  EXPECT_EQ(mergedConditions(base, "date_time: 2026-01-15T11:00:00Z").date_time_s, changed.date_time_s);
  EXPECT_EQ(changed.weather, Weather::kSnow);
  EXPECT_EQ(changed.searchlight, Searchlight::kOn);
  EXPECT_EQ(changed.world_seed, 3);
  EXPECT_EQ(changed.wind_m_s, 7.0);
  for (const char* yaml :
       {"{wheather: rain}", "rain", "{weather: hail}", "{weather: [rain]}", "{", "{wind_m_s: fast}"}) {
    EXPECT_THROW(mergedConditions(base, yaml), ParameterError) << yaml;
  }
}

// Solstices and equinox at 50 N: the noon elevation is 90 - 50 +- the obliquity, whatever the almanac.
TEST(SunPosition, noonElevations) {
  const auto highest = [](double day_start_s) {
    double best = -90.0;
    for (int minute = 0; minute < 1440; ++minute) {
      best = std::max(best, sunPosition(day_start_s + 60.0 * minute).elevation_rad * kDegPerRad);
    }
    return best;
  };
  EXPECT_NEAR(highest(parseDateTime("2026-06-21T00:00:00Z")), 40.0 + 23.436, 0.05);
  EXPECT_NEAR(highest(parseDateTime("2026-12-21T00:00:00Z")), 40.0 - 23.436, 0.05);
  EXPECT_NEAR(highest(parseDateTime("2026-03-20T00:00:00Z")), 40.0, 0.3);
}

// Meeus, Astronomical Algorithms, example 25.a: 1992-10-13T00:00 TD, declination -7.785 degrees: the
// elevation seen from the north pole.
TEST(SunPosition, agreesWithMeeus) {
  EXPECT_NEAR(sunPosition(parseDateTime("1992-10-13T00:00:00Z"), 90.0, 0.0).elevation_rad * kDegPerRad,
              -7.785, 0.02);
}

TEST(SunPosition, goesFromEastOverSouthToWest) {
  EXPECT_NEAR(sunPosition(parseDateTime("2026-03-20T05:10:00Z")).azimuth_rad * kDegPerRad, 90.0, 2.5);
  EXPECT_NEAR(sunPosition(parseDateTime("2026-03-20T11:10:00Z")).azimuth_rad * kDegPerRad, 180.0, 2.0);
  EXPECT_NEAR(sunPosition(parseDateTime("2026-03-20T17:10:00Z")).azimuth_rad * kDegPerRad, 270.0, 2.5);
}

TEST(Season, leavesComeTurnAndFall) {
  const Season winter = seasonOf(on("2026-01-15T11:00:00Z"));
  const Season summer = seasonOf(on("2026-07-01T11:00:00Z"));
  const Season autumn = seasonOf(on("2026-10-20T11:00:00Z"));
  const Season late_autumn = seasonOf(on("2026-11-20T11:00:00Z"));
  EXPECT_EQ(winter.leaf_density, 0.0);
  EXPECT_EQ(summer.leaf_density, 1.0);
  EXPECT_EQ(summer.leaf_turned, 0.0);
  EXPECT_GT(autumn.leaf_turned, 0.5);
  EXPECT_GT(late_autumn.litter, autumn.litter);
  EXPECT_GT(seasonOf(on("2026-05-01T11:00:00Z")).bud_freshness, 0.5);
  EXPECT_EQ(summer.snow_cover, 0.0);
}

TEST(Season, grassIsMown) {
  double shortest = 1.0;
  double longest = 0.0;
  for (int day = 1; day <= 30; ++day) {
    const double height =
        seasonOf(on("2026-06-" + std::string(day < 10 ? "0" : "") + std::to_string(day) + "T11:00:00Z"))
            .grass_height_m;
    shortest = std::min(shortest, height);
    longest = std::max(longest, height);
  }
  EXPECT_LT(shortest, 0.06);
  EXPECT_GT(longest, 0.12);
}

TEST(Season, itSnowsWhite) {
  Conditions conditions = on("2026-01-15T11:00:00Z");
  conditions.weather = Weather::kSnow;
  EXPECT_GT(seasonOf(conditions).snow_cover, 0.8);
}

TEST(Lighting, sunIsBrighterThanSkyAtNoonOnly) {
  const Lighting noon = lightingOf(on("2026-06-21T11:00:00Z"));
  const Lighting evening = lightingOf(on("2026-06-21T18:45:00Z"));
  const Lighting night = lightingOf(on("2026-06-21T23:00:00Z"));
  EXPECT_GT(noon.sun[1], 4.0 * noon.sky[1]);
  EXPECT_GT(evening.sun[0], 1.5 * evening.sun[2]) << "a low sun is red";
  EXPECT_EQ(night.sun[0], 0.0);
  EXPECT_LT(night.sky[1], 1e-4 * noon.sky[1]);
  EXPECT_EQ(noon.searchlight, 0.0);
  EXPECT_GT(night.searchlight, 0.0);
}

TEST(Lighting, shadowsMoveInSteps) {
  const double time_s = 20.0 * 89101980.0;
  EXPECT_EQ(shadowDirection(time_s), shadowDirection(time_s + 19.9));
  EXPECT_NE(shadowDirection(time_s), shadowDirection(time_s + 20.1));
}

}  // namespace
}  // namespace perennial::park
