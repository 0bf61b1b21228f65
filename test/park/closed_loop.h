#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/map_test_support.h"
#include "perennial/core/map_manager.h"
#include "perennial/core/odometer.h"
#include "perennial/core/repeat_session.h"
#include "perennial/core/teach_session.h"
#include "perennial/park/park_simulation.h"

namespace perennial {

inline constexpr double kDegree = M_PI / 180.0;

/// Where the robot was, from the taught path.
struct TrackError {
  double lateral_m = 0.0;  ///< to the left of it
  double along_m = 0.0;    ///< where navigation believed to be, minus where it was
};

inline double rms(const std::vector<TrackError>& errors, double TrackError::*part = &TrackError::lateral_m) {
  double sum = 0.0;
  for (const TrackError& error : errors) {
    sum += error.*part * error.*part;
  }
  return errors.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(errors.size()));
}

inline double largest(const std::vector<TrackError>& errors,
                      double TrackError::*part = &TrackError::lateral_m) {
  double worst = 0.0;
  for (const TrackError& error : errors) {
    worst = std::max(worst, std::abs(error.*part));
  }
  return worst;
}

/// What is wrong with the odometry of a repeat, over the one of the teaching.
struct OdometryFault {
  double scale = 0.0;      ///< the distance is (1 + this) times the true one
  double turn_slip = 0.0;  ///< in turns it is longer by this share on top: wheels that slip
};

/// Teaches and repeats the loop of the embedded world on the core alone.
class ClosedLoop : public ::testing::Test {
 protected:
  static OdometrySample sampleOf(const park::Odometry& odometry) {
    return {static_cast<double>(odometry.stamp_ns) * 1e-9, odometry.pose.x, odometry.pose.y, odometry.forward,
            odometry.angular};
  }

  /// The sample as a faulty odometry gives it: along a line, for only its length counts.
  OdometrySample faulty(const park::Odometry& odometry) {
    constexpr double kTurning = 0.15;  // rad/s
    OdometrySample sample = sampleOf(odometry);
    const double step_m = last_ ? std::hypot(sample.x_m - last_->x_m, sample.y_m - last_->y_m) : 0.0;
    last_ = sample;
    const double slip = std::abs(sample.angular_rad_s) > kTurning ? fault_.turn_slip : 0.0;
    faulty_m_ += step_m * (1.0 + fault_.scale) * (1.0 + slip);
    sample.x_m = faulty_m_;
    sample.y_m = 0.0;
    return sample;
  }

  /// Drives the loop once with the scripted driver and stores the map. Remembers the taught track.
  TeachSummary teach(park::ParkSimulation& park) {
    MapMetadata metadata;
    metadata.name = "loop";
    metadata.camera = "camera";
    TeachSession session(folder_ / "loop.perennial", metadata, true, {}, settings_.extraction);
    taught_.clear();
    taught_m_.clear();
    Odometer odometer;
    park.place(0.0, 0.0);
    park.setDriver(true);
    while (!park.driverFinished()) {
      const park::ParkFrame frame = park.step();
      for (const park::Odometry& odometry : frame.odometry) {
        EXPECT_EQ(odometer.add(sampleOf(odometry)), "");
      }
      const double stamp_s = static_cast<double>(frame.stamp_ns) * 1e-9;
      session.addImage(stamp_s, *odometer.distanceAt(stamp_s), frame.image, "mono8");
      const Velocity command = park.driverCommand();
      session.addCommand(odometer.newestDistance(), command);
      park.command(command);
      taught_.push_back(frame.true_pose);
      taught_m_.push_back(*odometer.distanceAt(stamp_s));
    }
    park.setDriver(false);
    return session.finish(odometer.newestDistance());
  }

  /// From the taught track (not from the ideal path). The loop ends where it starts: of the two the one that
  /// fits `distance_m`, where navigation believes to be.
  TrackError errorOf(const park::Pose& pose, double distance_m) const {
    TrackError best;
    double nearest = 1e9;
    for (std::size_t i = 0; i < taught_.size(); ++i) {
      if (std::abs(taught_m_[i] - distance_m) > 8.0) {
        continue;
      }
      const double dx = pose.x - taught_[i].x;
      const double dy = pose.y - taught_[i].y;
      if (std::hypot(dx, dy) < nearest) {
        nearest = std::hypot(dx, dy);
        best.lateral_m = -std::sin(taught_[i].heading) * dx + std::cos(taught_[i].heading) * dy;
        best.along_m =
            distance_m - taught_m_[i] - std::cos(taught_[i].heading) * dx - std::sin(taught_[i].heading) * dy;
      }
    }
    return best;
  }

  /// Repeats the path `traversals` times without a stop; the errors of each traversal.
  std::vector<std::vector<TrackError>> repeat(park::ParkSimulation& park, MapManager& manager,
                                              int traversals) {
    RepeatSession session(manager.file().metadata(), manager.file().profile(), manager.file().size(),
                          settings_);
    session.setFocalLength(park.settings().camera.geometry.fx);
    Odometer odometer;
    std::vector<std::vector<TrackError>> errors;
    double start_m = 0.0;
    std::optional<double> travelled_m;
    for (int traversal = 0; traversal < traversals; ++traversal) {
      manager.beginTraversal(static_cast<double>(park.nowNs()) * 1e-9);
      session.beginTraversal(start_m, travelled_m);
      errors.emplace_back();
      do {
        const park::ParkFrame frame = park.step();
        for (const park::Odometry& odometry : frame.odometry) {
          EXPECT_EQ(odometer.add(faulty(odometry)), "");
        }
        const double stamp_s = static_cast<double>(frame.stamp_ns) * 1e-9;
        travelled_m = odometer.distanceAt(stamp_s);
        for (const std::uint32_t index : manager.due(session.distance(*travelled_m))) {
          session.add(manager.activeMap(index));
        }
        const NavigationStep step = session.step(stamp_s, *travelled_m, frame.image);
        manager.observe(step.local_map, step.local_map_distance_m, observationOf(step));
        park.command(step.velocity);
        errors.back().push_back(errorOf(frame.true_pose, step.distance_m));
        lost_ = std::abs(errors.back().back().lateral_m) > 2.0;
        registered_ += step.registration.result.displacement_px.has_value();
        ++images_;
      } while (!session.atEnd(*travelled_m) && !lost_ && errors.back().size() < 2000);
      EXPECT_FALSE(lost_ && !may_get_lost_) << "more than 2 m beside the path";
      EXPECT_LT(errors.back().size(), 2000U) << "did not finish the loop";
      start_m = session.distance(*travelled_m) - session.length();
      manager.endTraversal(true, static_cast<double>(park.nowNs()) * 1e-9);
    }
    return errors;
  }

  MapManager manager(std::shared_ptr<MapStrategy> strategy) const {
    return MapManager(MapFile(folder_ / "loop.perennial"), std::move(strategy));
  }

  TemporaryFolder folder_;
  RepeatSettings settings_;
  bool may_get_lost_ = false;
  bool lost_ = false;
  OdometryFault fault_;
  std::vector<park::Pose> taught_;
  std::vector<double> taught_m_;  ///< by the odometer
  std::optional<OdometrySample> last_;
  double faulty_m_ = 0.0;
  int images_ = 0;
  int registered_ = 0;
};

}  // namespace perennial
