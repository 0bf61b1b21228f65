// A whole teach and repeat in one process, on the core alone: images are cut from a random texture, their
// position is the camera's heading.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <random>

#include "core/map_test_support.h"
#include "perennial/core/error.h"
#include "perennial/core/map_manager.h"
#include "perennial/core/repeat_session.h"
#include "perennial/core/teach_session.h"
#include "perennial/strategies/latest_map.h"
#include "perennial/strategies/score_based.h"
#include "perennial/strategies/static_map.h"

namespace perennial {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 200;
constexpr double kStep_m = 0.1;

/// What the camera sees at a place of the path, turned to the left by `left_px`.
cv::Mat viewAt(int place, int left_px) {
  cv::Mat noise(kHeight, kWidth + 400, CV_8UC1);
  cv::theRNG().state = 1000U + static_cast<unsigned>(place) / 20U;
  cv::randu(noise, 0, 256);
  cv::GaussianBlur(noise, noise, {0, 0}, 3.0);
  cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  return noise(cv::Rect(200 - left_px, 0, kWidth, kHeight)).clone();
}

class TeachRepeat : public ::testing::Test {
 protected:
  std::string file() const { return folder_ / "loop.perennial"; }

  TeachSummary teach(int places = 100) {
    MapMetadata metadata;
    metadata.name = "loop";
    metadata.camera = "camera";
    TeachSession session(file(), metadata, false, {}, {});
    session.addCommand(0.0, {0.5, 0.0, 0.0});
    for (int place = 0; place <= places; ++place) {
      session.addImage(100.0 + place, 7.0 + place * kStep_m, viewAt(place, 0), "mono8");
    }
    return session.finish(7.0 + places * kStep_m);
  }

  /// One traversal with the camera turned left by `left_px`; returns its steps.
  std::vector<NavigationStep> repeat(MapManager& manager, int left_px, double start_m = 0.0) {
    RepeatSettings settings;
    settings.along_path.enabled =
        false;  // all views of 2 m are alike here: they say nothing about where they were taken
    RepeatSession session(manager.file().metadata(), manager.file().profile(), manager.file().size(),
                          settings);
    session.beginTraversal(start_m);
    manager.beginTraversal(1000.0);
    std::vector<NavigationStep> steps;
    for (int place = static_cast<int>(std::lround(start_m / kStep_m)); place <= 100; ++place) {
      const double travelled_m = 50.0 + place * kStep_m - start_m;
      for (const std::uint32_t index : manager.due(start_m + travelled_m - 50.0)) {
        session.add(manager.activeMap(index));
      }
      EXPECT_TRUE(session.ready(travelled_m));
      steps.push_back(session.step(1000.0 + place, travelled_m, viewAt(place, left_px)));
      const NavigationStep& step = steps.back();
      manager.observe(step.local_map, step.local_map_distance_m, observationOf(step));
    }
    return steps;
  }

  TemporaryFolder folder_;
};

TEST_F(TeachRepeat, teachingMakesALocalMapEveryInterval) {
  const TeachSummary summary = teach();
  EXPECT_EQ(summary.local_maps, 51U);
  EXPECT_NEAR(summary.distance_m, 10.0, 1e-9);
  const MapFile map(file());
  EXPECT_EQ(map.read(0).distance_m, 0.0) << "the first image is at distance 0";
  EXPECT_NEAR(map.read(50).distance_m, 10.0, 1e-9);
  EXPECT_EQ(map.metadata().image_width, kWidth);
  EXPECT_EQ(map.metadata().taught_stamp_s, 100.0);
  EXPECT_EQ(map.profile().at(3.0).forward, 0.5);
}

TEST_F(TeachRepeat, repeatsWithTheDisplacementOfTheCamera) {
  teach();
  MapManager manager(MapFile(file()), std::make_shared<strategies::StaticMap>());
  // Turned left, the scene moves right in the view: x_map - x_view is negative, the robot must turn right.
  for (const NavigationStep& step : repeat(manager, 24)) {
    ASSERT_TRUE(step.registration.result.displacement_px);
    EXPECT_NEAR(*step.registration.result.displacement_px, -24.0, 1.0);
    EXPECT_LT(step.velocity.angular, 0.0);
    EXPECT_EQ(step.velocity.forward, 0.5);
    EXPECT_LE(std::abs(step.local_map_distance_m - step.distance_m), 0.1 + 1e-9);
  }
}

TEST_F(TeachRepeat, aMapComesWithTheEdgesOfItsTaughtImage) {
  teach();
  const MapManager manager(MapFile(file()), std::make_shared<strategies::StaticMap>());
  const EdgeField taught = FeatureExtractor().extract(viewAt(40, 0)).edges;
  ASSERT_FALSE(taught.empty());
  ASSERT_EQ(manager.activeMap(20).alternatives.size(), 1U);
  EXPECT_EQ(manager.activeMap(20).alternatives[0].features.edges, taught);
  const ActiveMap without = manager.activeMapWithoutEdges(20);
  EXPECT_TRUE(without.alternatives[0].features.edges.empty());
  EXPECT_EQ(without.alternatives[0].features, manager.activeMap(20).alternatives[0].features);
}

TEST_F(TeachRepeat, startsInTheMiddle) {
  teach();
  MapManager manager(MapFile(file()), std::make_shared<strategies::StaticMap>());
  const auto steps = repeat(manager, -10, 4.0);
  EXPECT_EQ(steps.front().local_map, 20U);
  EXPECT_NEAR(*steps.front().registration.result.displacement_px, 10.0, 1.0);
  EXPECT_EQ(steps.back().local_map, 50U);
}

TEST_F(TeachRepeat, learnsOncePerLocalMapAndInTheMapsFrame) {
  teach();
  MapManager manager(MapFile(file()), std::make_shared<strategies::LatestMap>());
  repeat(manager, 30);
  EXPECT_EQ(manager.endTraversal(true, 2000.0), 51U);
  const auto steps = repeat(manager, 30);  // against what was learned at 30 px, inserted at x + displacement
  for (const NavigationStep& step : steps) {
    EXPECT_NEAR(*step.registration.result.displacement_px, -30.0, 1.5);
  }
  EXPECT_EQ(manager.file().traversals().size(), 2U);
}

TEST_F(TeachRepeat, aMapThatNothingChangesDoesNotGrow) {
  teach();
  MapManager manager(MapFile(file()), std::make_shared<strategies::StaticMap>());
  const std::uint64_t size = manager.file().sizes().file_bytes;
  repeat(manager, 5);
  EXPECT_EQ(manager.endTraversal(true, 2000.0), 0U);
  EXPECT_EQ(manager.file().sizes().file_bytes, size);
  EXPECT_EQ(manager.file().traversals().size(), 1U);
}

TEST_F(TeachRepeat, learnsOnlyFromWhatItIsSureOf) {
  teach();
  MapManagerSettings settings;
  settings.gate.min_confidence = 1.0;  // which no estimate reaches
  MapManager manager(MapFile(file()), std::make_shared<strategies::LatestMap>(), settings);
  for (const NavigationStep& step : repeat(manager, 30)) {
    EXPECT_GT(step.registration.result.confidence, 0.9);
  }
  EXPECT_EQ(manager.endTraversal(true, 2000.0), 0U);
}

TEST_F(TeachRepeat, aForgottenTraversalChangesNothing) {
  teach();
  const LocalMap before = MapFile(file()).read(25);
  MapManager manager(MapFile(file()), std::make_shared<strategies::ScoreBased>());
  repeat(manager, 5);
  EXPECT_EQ(manager.endTraversal(false, 2000.0), 0U);
  EXPECT_EQ(manager.file().read(25).features, before.features);
  EXPECT_EQ(manager.file().traversals().size(), 1U);
}

TEST_F(TeachRepeat, isDeterministic) {
  teach();
  std::vector<std::vector<NavigationStep>> runs;
  for (int run = 0; run < 2; ++run) {
    MapManager manager(MapFile(file()), std::make_shared<strategies::StaticMap>());
    runs.push_back(repeat(manager, 13));
  }
  ASSERT_EQ(runs[0].size(), runs[1].size());
  for (std::size_t i = 0; i < runs[0].size(); ++i) {
    EXPECT_EQ(*runs[0][i].registration.result.displacement_px,
              *runs[1][i].registration.result.displacement_px);
    EXPECT_EQ(runs[0][i].view, runs[1][i].view);
  }
}

TEST_F(TeachRepeat, refusesUnsuitableImagesAndMaps) {
  teach();
  const MapFile map(file());
  const RepeatSession session(map.metadata(), map.profile(), map.size(), {});
  EXPECT_NO_THROW(session.requireSuitable(viewAt(0, 0), "mono8"));
  EXPECT_THROW(session.requireSuitable(viewAt(0, 0), "bgr8"), ImageError);
  EXPECT_THROW(session.requireSuitable(cv::Mat(100, 100, CV_8UC1), "mono8"), ImageError);
  RepeatSettings other;
  other.extraction.features = 123;
  EXPECT_THROW(RepeatSession(map.metadata(), map.profile(), map.size(), other), MapError);
}

TEST_F(TeachRepeat, nothingIsStoredWithoutMovementVelocityOrImages) {
  MapMetadata metadata;
  metadata.name = "loop";
  {
    TeachSession session(file(), metadata, false, {}, {});
    EXPECT_THROW(session.finish(0.0), MapError);
  }
  {
    TeachSession session(file(), metadata, false, {}, {});
    session.addCommand(0.0, {0.5, 0.0, 0.0});
    session.addImage(1.0, 0.0, viewAt(0, 0), "mono8");
    EXPECT_THROW(session.finish(0.0), MapError) << "odometry that does not move";
  }
  {
    TeachSession session(file(), metadata, false, {}, {});
    session.addImage(1.0, 0.0, viewAt(0, 0), "mono8");
    EXPECT_THROW(session.finish(1.0), MapError) << "no velocities";
  }
  EXPECT_FALSE(std::filesystem::exists(file()));
}

TEST_F(TeachRepeat, velocitiesComeFromTheOdometryWhereThereAreNoCommands) {
  MapMetadata metadata;
  metadata.name = "loop";
  TeachSession session(file(), metadata, false, {}, {});
  session.addImage(1.0, 0.0, viewAt(0, 0), "mono8");
  session.addMeasuredVelocity(0.0, {0.301, 0.0, 0.0});
  session.addMeasuredVelocity(0.5, {0.299, 0.1, 0.0});
  session.finish(1.0);
  const MapFile map(file());
  EXPECT_NEAR(map.profile().at(0.2).forward, 0.3, 1e-9) << "in steps of velocity_step";
  EXPECT_NEAR(map.profile().at(0.7).angular, 0.1, 1e-9);
}

TEST_F(TeachRepeat, existingMapsAreNotOverwritten) {
  teach();
  MapMetadata metadata;
  metadata.name = "loop";
  EXPECT_THROW(TeachSession(file(), metadata, false, {}, {}), MapError);
  EXPECT_NO_THROW(TeachSession(file(), metadata, true, {}, {}));
  EXPECT_EQ(MapFile(file()).size(), 51U) << "the old one stays until a new one is finished";
}

}  // namespace
}  // namespace perennial
