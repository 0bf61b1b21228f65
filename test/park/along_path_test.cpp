// What the along-path correction is worth when the odometry is wrong. PERENNIAL_ALONG_PATH_TABLE=1 measures
// the whole table of docs/navigation.md; without it one row is tested.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "park/closed_loop.h"
#include "perennial/core/feature_extractor.h"
#include "perennial/core/place_finder.h"
#include "perennial/strategies/static_map.h"

namespace perennial {
namespace {

class AlongPath : public ClosedLoop {
 protected:
  AlongPath() {
    park::ParkSettings settings;
    settings.image_rate_hz = 5;
    park_ = std::make_unique<park::ParkSimulation>(settings, park::Conditions());
    teach(*park_);
  }

  /// The errors of one loop, begun on the path.
  std::vector<TrackError> loop(const OdometryFault& fault, bool corrected) {
    park_->place(0.0, 0.0);
    fault_ = fault;
    last_.reset();
    settings_.along_path.enabled = corrected;
    may_get_lost_ = true;  // without the correction it may
    MapManager maps = manager(std::make_shared<strategies::StaticMap>());
    const std::vector<TrackError> errors = repeat(*park_, maps, 1).front();
    std::printf("| %2.0f %% | %2.0f %% | %s | %.3f | %.3f | %.3f | %.3f |\n", 100.0 * fault.scale,
                100.0 * fault.turn_slip, corrected ? "with" : "without", rms(errors), largest(errors),
                rms(errors, &TrackError::along_m), largest(errors, &TrackError::along_m));
    std::fflush(stdout);
    return errors;
  }

  /// A robot that was put beside the start of the loop knows where it stands.
  void findTheStart() {
    const MapManager maps = manager(std::make_shared<strategies::StaticMap>());
    park_->place(0.2, 0.0);
    const park::ParkFrame frame = park_->step();
    LocalisationSettings settings;
    settings.loop = true;
    PlaceFinder finder(settings);
    finder.seek(FeatureExtractor(settings_.extraction).extract(frame.image));
    for (std::uint32_t i = 0; i < maps.file().size(); ++i) {
      finder.consider(std::make_shared<ActiveMap>(activate(maps.strategy(), maps.file().read(i), 0.0)));
    }
    const PlaceGuess guess = finder.guess();
    std::printf("0.2 m beside the start: %s\n", guess.reason.c_str());
    EXPECT_TRUE(guess.sure) << guess.reason;
    EXPECT_LE(guess.distance_m, 0.6);
  }

  std::unique_ptr<park::ParkSimulation> park_;
};

TEST_F(AlongPath, correctsAnOdometryThatIsWrong) {
  findTheStart();
  const std::vector<TrackError> errors = loop({0.05, 0.0}, true);
  EXPECT_FALSE(lost_);
  EXPECT_LE(rms(errors), 0.10);
  EXPECT_LE(largest(errors, &TrackError::along_m), 0.5);
  if (std::getenv("PERENNIAL_ALONG_PATH_TABLE") == nullptr) {
    return;
  }
  for (const OdometryFault& fault :
       {OdometryFault{0.0, 0.0}, OdometryFault{0.02, 0.0}, OdometryFault{0.05, 0.0}, OdometryFault{0.10, 0.0},
        OdometryFault{0.0, 0.1}, OdometryFault{0.02, 0.1}, OdometryFault{0.05, 0.1},
        OdometryFault{0.10, 0.1}}) {
    const double without = rms(loop(fault, false));
    const double with = rms(loop(fault, true));
    EXPECT_LE(with, without + 0.01) << "the correction must never be worse";
  }
}

}  // namespace
}  // namespace perennial
