// Teach and repeat in the embedded world, on the core alone: the loop is closed through rendered images.
#include <cstdio>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "park/closed_loop.h"
#include "perennial/strategies/score_based.h"
#include "perennial/strategies/static_map.h"

namespace perennial {
namespace {

TEST_F(ClosedLoop, convergesFromBesideThePath) {
  park::ParkSettings settings;
  settings.image_rate_hz = 5;  // what a slow computer manages; the demo runs at 15
  park::ParkSimulation park(settings, {});
  const TeachSummary taught = teach(park);
  EXPECT_GT(taught.distance_m, 30.0);
  park.place(0.4, 6.0 * kDegree);
  MapManager maps = manager(std::make_shared<strategies::StaticMap>());
  const auto errors = repeat(park, maps, 1).front();
  const std::vector<TrackError> second_half(errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
  std::printf("from 0.4 m and 6 degrees off: cross-track RMS %.3f m over the second half, largest there %.3f m, "
              "%d of %d images registered\n",
              rms(second_half), largest(second_half), registered_, images_);
  EXPECT_GT(largest(errors), 0.3) << "it did start beside the path";
  EXPECT_LE(rms(second_half), 0.10);
}

TEST_F(ClosedLoop, tenLoopsWithNoisyOdometryStayOnThePath) {
  park::ParkSettings settings;
  settings.image_rate_hz = 5;
  settings.robot.odometry_noise = 0.02;
  settings.robot.heading_noise = 0.02;
  park::ParkSimulation park(settings, {});
  teach(park);
  park.place(0.0, 0.0);
  MapManager maps = manager(std::make_shared<strategies::ScoreBased>());
  const auto loops = repeat(park, maps, 10);
  ASSERT_EQ(loops.size(), 10U);
  for (std::size_t i = 0; i < loops.size(); ++i) {
    std::printf("loop %zu: cross-track RMS %.3f m, largest %.3f m\n", i + 1, rms(loops[i]), largest(loops[i]));
    EXPECT_LE(largest(loops[i]), 0.15) << "loop " << i + 1;
  }
}

}  // namespace
}  // namespace perennial
