// A robot that repeats a path for years, in one process and in simulated time: memory, time per traversal and
// numbers must not drift. PERENNIAL_TRAVERSALS says how many traversals; the figures of 10000 stand in
// docs/reliability.md.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/map_test_support.h"
#include "perennial/core/map_manager.h"
#include "perennial/core/navigation_supervisor.h"
#include "perennial/core/odometer.h"
#include "perennial/core/repeat_session.h"
#include "perennial/core/teach_session.h"
#include "perennial/strategies/score_based.h"

namespace perennial {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 200;
constexpr int kPlaces = 11;
constexpr double kStep_m = 0.1;
constexpr int kKept = 10;
constexpr double kMostPerTraversal_mb = 0.05;  // twice what was measured
/// All places with all of their 300 features, and a number each.
constexpr double kWholeState_mb = kPlaces * 300 * 68 / 1e6;

cv::Mat viewAt(int left_px) {
  cv::Mat noise(kHeight, kWidth + 100, CV_8UC1);
  cv::theRNG().state = 77U;
  cv::randu(noise, 0, 256);
  cv::GaussianBlur(noise, noise, {0, 0}, 3.0);
  cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  return noise(cv::Rect(50 - left_px, 0, kWidth, kHeight)).clone();
}

double residentMegabytes() {
  std::ifstream statm("/proc/self/statm");
  double total = 0.0, resident = 0.0;
  statm >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

double processorSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

class LongRun : public ::testing::Test {
 protected:
  LongRun() {
    extraction_.features = 300;
    MapMetadata metadata;
    metadata.name = "loop";
    TeachSession session(file(), metadata, false, {}, extraction_);
    session.addCommand(0.0, {0.5, 0.0, 0.0});
    for (int place = 0; place < kPlaces; ++place) {
      session.addImage(100.0 + place, place * kStep_m, viewAt(0), "mono8");
    }
    session.finish((kPlaces - 1) * kStep_m);
    for (const int left_px : {-6, 0, 6}) {
      views_.push_back(viewAt(left_px));
    }
  }

  std::string file() const { return folder_ / "loop.perennial"; }
  double mapMegabytes() const { return static_cast<double>(std::filesystem::file_size(file())) / 1e6; }

  /// One traversal through everything that a robot runs; the odometer and the session go on from the one
  /// before.
  void traverse(int number, MapManager& manager, RepeatSession& session) {
    manager.beginTraversal(now_s_);
    session.beginTraversal(0.0, number == 0 ? std::optional<double>() : odometer_.newestDistance());
    supervisor_.start(now_s_);
    const int turned = number % 3;
    for (int place = 0; place < kPlaces; ++place) {
      now_s_ += 0.2;
      x_m_ += place == 0 ? 0.0 : kStep_m;
      ASSERT_EQ(odometer_.add({now_s_, x_m_, 0.0, 0.5, 0.0}), "");
      const double travelled_m = *odometer_.distanceAt(now_s_);
      for (const std::uint32_t index : manager.due(session.distance(travelled_m))) {
        session.add(manager.activeMap(index));
      }
      session.stepInto(now_s_, travelled_m, views_[static_cast<std::size_t>(turned)], step_);
      session.correctAlongPath(step_);
      supervisor_.see(now_s_, travelled_m, sightOf(step_.registration.result), {});
      ASSERT_EQ(supervisor_.status().mode, NavigationMode::kRepeating) << "traversal " << number;
      ASSERT_NEAR(*step_.registration.result.displacement_px, -6.0 * (turned - 1), 1.0)
          << "traversal " << number;
      ASSERT_NEAR(step_.distance_m, place * kStep_m, 1e-6) << "traversal " << number;
      manager.observe(step_.local_map, step_.local_map_distance_m, observationOf(step_));
    }
    now_s_ += 600.0;
    manager.endTraversal(true, now_s_);
  }

  TemporaryFolder folder_;
  ExtractionSettings extraction_;
  Odometer odometer_;
  NavigationSupervisor supervisor_;
  NavigationStep step_;
  std::vector<cv::Mat> views_;
  double now_s_ = 1.8e9;
  double x_m_ = 0.0;
};

TEST_F(LongRun, nothingDrifts) {
  const char* wanted = std::getenv("PERENNIAL_TRAVERSALS");
  const int traversals = wanted != nullptr ? std::max(100, std::atoi(wanted)) : 200;
  RepeatSettings settings;
  settings.extraction = extraction_;
  settings.along_path.enabled = false;  // all places look alike here
  MapManager manager(MapFile(file()), std::make_shared<strategies::ScoreBased>());
  RepeatSession session(manager.file().metadata(), manager.file().profile(), manager.file().size(), settings);
  const int part = traversals / 5;
  const double taught_mb = mapMegabytes();
  std::vector<double> memory_mb, seconds, map_mb;
  for (int number = 0; number < 5 * part; ++number) {
    const double begin_s = processorSeconds();
    ASSERT_NO_FATAL_FAILURE(traverse(number, manager, session));
    if (number % part == 0) {
      seconds.push_back(0.0);
    }
    seconds.back() += processorSeconds() - begin_s;
    if (number % part == part - 1) {
      memory_mb.push_back(residentMegabytes());
      map_mb.push_back(mapMegabytes());
      std::printf("%6d traversals: %.1f MB of memory, %.2f ms a traversal, map %.2f MB\n", number + 1,
                  memory_mb.back(), 1000.0 * seconds.back() / part, map_mb.back());
    }
  }
  EXPECT_LT(memory_mb.back() - memory_mb.front(), 10.0) << "memory must not grow with the traversals";
  EXPECT_LT(seconds.back(), 3.0 * seconds.front()) << "nor the time";
  const double first_part_mb = map_mb[1] - map_mb[0];
  const double last_part_mb = map_mb[4] - map_mb[3];
  EXPECT_LT(last_part_mb, 1.2 * first_part_mb + 0.1) << "nor what a traversal adds to the map";
  EXPECT_LT((map_mb[4] - taught_mb) / (5 * part), kMostPerTraversal_mb);
  MapFile(file()).compact(kKept);
  std::printf("%6d traversals kept after compaction: map %.2f MB\n", kKept, mapMegabytes());
  EXPECT_LT(mapMegabytes(), taught_mb + kWholeState_mb + kKept * kMostPerTraversal_mb)
      << "as taught, one state for all that was merged, and those that are kept";
}

}  // namespace
}  // namespace perennial
