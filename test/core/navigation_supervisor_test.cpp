// Every transition of the supervisor, and which reason wins when there are several.
#include "perennial/core/navigation_supervisor.h"

#include <gtest/gtest.h>

#include "perennial/core/error.h"
#include "perennial/core/sight.h"

namespace perennial {
namespace {

using Mode = NavigationMode;
using Kind = MotionPermit::Kind;

const Sight kSure{true, 1.0};
const Sight kBlind{false, 0.0};

class Supervisor : public ::testing::Test {
 protected:
  Supervisor() {
    settings_.max_blind_distance_m = 2.0;
    settings_.sights_to_trust = 3;
    settings_.hold_timeout_s = 10.0;
    supervisor_ = NavigationSupervisor(settings_);
  }

  /// An image every 0.1 s, 0.05 m further on.
  const NavigationStatus& see(const Sight& sight, const MotionPermit& permit = {}) {
    now_s_ += 0.1;
    travelled_m_ += moves_ ? 0.05 : 0.0;
    return supervisor_.see(now_s_, travelled_m_, sight, permit);
  }
  const NavigationStatus& watch(double after_s, const std::string& missing = "",
                                const MotionPermit& permit = {}) {
    now_s_ += after_s;
    return supervisor_.watch(now_s_, missing, permit);
  }
  /// A goal, and the path is recognised from the first image on; the robot stands until it may drive.
  void startAndSee() {
    supervisor_.start(now_s_);
    moves_ = false;
    for (int i = 1; i < settings_.sights_to_trust; ++i) {
      ASSERT_EQ(see(kSure).mode, Mode::kStarting) << i;
    }
    ASSERT_EQ(see(kSure).mode, Mode::kRepeating);
    moves_ = true;
  }
  void driveBlindUntilHolding() {
    for (int i = 0; i < 200 && supervisor_.status().mode != Mode::kHolding; ++i) {
      see(kBlind);
    }
    ASSERT_EQ(supervisor_.status().mode, Mode::kHolding);
    moves_ = false;
  }

  SupervisorSettings settings_;
  NavigationSupervisor supervisor_;
  double now_s_ = 1000.0;
  double travelled_m_ = 5.0;
  bool moves_ = true;
};

TEST_F(Supervisor, isIdleWithoutAGoal) {
  EXPECT_EQ(supervisor_.status().mode, Mode::kIdle);
  EXPECT_FALSE(supervisor_.active());
  EXPECT_EQ(see(kSure).mode, Mode::kIdle) << "images alone do not start a robot";
  EXPECT_EQ(watch(100.0, "image").mode, Mode::kIdle);
}

TEST_F(Supervisor, startsAndRepeats) {
  supervisor_.start(now_s_);
  EXPECT_EQ(supervisor_.status().mode, Mode::kStarting);
  EXPECT_EQ(supervisor_.status().speed_factor, 0.0);
  EXPECT_EQ(watch(0.1).mode, Mode::kStarting);
  for (int i = 1; i < settings_.sights_to_trust; ++i) {
    EXPECT_EQ(see(kSure).mode, Mode::kStarting) << "fewer in a row may be chance";
    EXPECT_EQ(supervisor_.status().speed_factor, 0.0);
    EXPECT_NE(supervisor_.status().reason.find("3 images in a row"), std::string::npos);
  }
  EXPECT_EQ(see(kSure).mode, Mode::kRepeating);
  EXPECT_EQ(supervisor_.status().speed_factor, 1.0);
  EXPECT_FALSE(supervisor_.status().reason.empty());
}

TEST_F(Supervisor, speedFollowsConfidence) {
  startAndSee();
  EXPECT_EQ(see({true, settings_.full_confidence}).speed_factor, 1.0);
  const double half = see({true, settings_.full_confidence / 2.0}).speed_factor;
  EXPECT_NEAR(half, (1.0 + settings_.least_speed) / 2.0, 1e-12);
  EXPECT_NEAR(see({true, 0.0}).speed_factor, settings_.least_speed, 1e-12);
  EXPECT_EQ(supervisor_.status().mode, Mode::kRepeating);
}

TEST_F(Supervisor, drivesSlowerByOdometryThenHolds) {
  startAndSee();
  const double blind_from_m = travelled_m_;
  EXPECT_EQ(see(kBlind).mode, Mode::kDegraded);
  EXPECT_EQ(supervisor_.status().speed_factor, settings_.blind_speed);
  driveBlindUntilHolding();
  EXPECT_NEAR(travelled_m_ - blind_from_m, settings_.max_blind_distance_m, 0.051);
  EXPECT_EQ(supervisor_.status().speed_factor, 0.0);
  EXPECT_NE(supervisor_.status().reason.find("not recognised for 2.0 m"), std::string::npos);
}

TEST_F(Supervisor, standsUntilThePathIsRecognised) {
  supervisor_.start(now_s_);
  moves_ = false;
  for (int i = 0; i < 90; ++i) {  // by chance, now and then, but never often enough in a row
    ASSERT_EQ(see(i % 4 == 0 ? kSure : kBlind).mode, Mode::kStarting) << i;
    ASSERT_EQ(supervisor_.status().speed_factor, 0.0);
  }
  EXPECT_NE(see(kBlind).reason.find("not recognised here"), std::string::npos);
  EXPECT_NE(supervisor_.status().reason.find("localise"), std::string::npos);
  see(kSure);
  see(kSure);
  EXPECT_EQ(see(kSure).mode, Mode::kRepeating);
  EXPECT_EQ(see(kBlind).mode, Mode::kDegraded) << "from now on it may be blind for a while";
}

TEST_F(Supervisor, failsWhereThePathIsNeverRecognised) {
  supervisor_.start(now_s_);
  moves_ = false;
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(see(kBlind).mode, Mode::kStarting) << i;
  }
  see(kBlind);
  see(kBlind);
  EXPECT_EQ(supervisor_.status().mode, Mode::kFailed);
  EXPECT_NE(supervisor_.status().reason.find("not recognised here"), std::string::npos);
}

TEST_F(Supervisor, whatStandsInTheWayOfAStartIsNamedFirst) {
  supervisor_.start(now_s_);
  moves_ = false;
  const MotionPermit hold{Kind::kHold, 0.0, "something is in the way, 0.3 m ahead", {}};
  EXPECT_EQ(see(kBlind, hold).mode, Mode::kHolding);
  EXPECT_EQ(see(kBlind).mode, Mode::kStarting);
  EXPECT_EQ(watch(settings_.sensor_timeout_s + 0.1, "image").mode, Mode::kStopped);
  EXPECT_EQ(see(kBlind).mode, Mode::kStarting);
}

TEST_F(Supervisor, startsBlindlyWhereThatIsAskedFor) {
  settings_.max_blind_start_m = 1.0;
  supervisor_ = NavigationSupervisor(settings_);
  supervisor_.start(now_s_);
  EXPECT_EQ(see(kBlind).mode, Mode::kDegraded) << "the distance travelled before does not count";
  const double from_m = travelled_m_;
  while (supervisor_.status().mode == Mode::kDegraded) {
    EXPECT_EQ(supervisor_.status().speed_factor, settings_.least_speed);
    ASSERT_LT(travelled_m_ - from_m, 1.1);
    see(kBlind);
  }
  EXPECT_NEAR(travelled_m_ - from_m, 1.0, 0.051);
  EXPECT_EQ(supervisor_.status().mode, Mode::kStarting);
  EXPECT_EQ(supervisor_.status().speed_factor, 0.0);
}

TEST_F(Supervisor, aRobotThatWasFoundNeedNotBeRecognisedAgain) {
  supervisor_.start(now_s_);
  supervisor_.prepare(now_s_, "looking for the place", {});
  supervisor_.trustPlace();
  EXPECT_EQ(see(kSure).mode, Mode::kRepeating);
  EXPECT_EQ(see(kBlind).mode, Mode::kDegraded);
  supervisor_.start(now_s_);
  EXPECT_EQ(see(kSure).mode, Mode::kStarting) << "but for the next goal";
}

TEST_F(Supervisor, blindnessOnceInAWhileDoesNotAddUp) {
  startAndSee();
  for (int i = 0; i < 300; ++i) {
    EXPECT_NE(see(i % 10 < settings_.sights_to_trust ? kSure : kBlind).mode, Mode::kHolding);
  }
}

TEST_F(Supervisor, aLuckySightNowAndThenDoesNotMakeItSee) {
  startAndSee();
  const double blind_from_m = travelled_m_;
  const int lucky = settings_.sights_to_trust - 1;
  for (int i = 0; supervisor_.status().mode != Mode::kHolding; ++i) {
    ASSERT_LT(travelled_m_ - blind_from_m, settings_.max_blind_distance_m + 0.1);
    see(i % 10 < 10 - lucky ? kBlind : kSure);
  }
  moves_ = false;
  for (int i = 0; i < 30; ++i) {
    EXPECT_EQ(see(i % 10 < 10 - lucky ? kBlind : kSure).mode, Mode::kHolding);
  }
}

TEST_F(Supervisor, trustsASingleSightWhereThatIsAskedFor) {
  settings_.sights_to_trust = 1;
  supervisor_ = NavigationSupervisor(settings_);
  startAndSee();
  driveBlindUntilHolding();
  EXPECT_EQ(see(kSure).mode, Mode::kRepeating);
}

TEST_F(Supervisor, goesOnByItselfWhenItSeesAgain) {
  startAndSee();
  driveBlindUntilHolding();
  EXPECT_EQ(see(kBlind).mode, Mode::kHolding) << "it retries";
  EXPECT_EQ(see(kSure).mode, Mode::kHolding) << "once may be chance";
  EXPECT_EQ(see(kSure).mode, Mode::kHolding);
  EXPECT_EQ(see(kSure).mode, Mode::kRepeating);
  EXPECT_EQ(see(kBlind).mode, Mode::kDegraded) << "and may be blind for the whole distance again";
}

TEST_F(Supervisor, failsAfterHoldingForTooLong) {
  startAndSee();
  driveBlindUntilHolding();
  for (int i = 0; i < 99; ++i) {
    ASSERT_EQ(see(kBlind).mode, Mode::kHolding) << i;
  }
  see(kBlind);
  see(kBlind);
  EXPECT_EQ(supervisor_.status().mode, Mode::kFailed);
  EXPECT_FALSE(supervisor_.active());
}

TEST_F(Supervisor, stopsWithoutDataAndGoesOnWithIt) {
  startAndSee();
  EXPECT_EQ(watch(settings_.sensor_timeout_s - 0.1, "image").mode, Mode::kRepeating);
  EXPECT_EQ(watch(0.2, "odometry").mode, Mode::kStopped);
  EXPECT_NE(supervisor_.status().reason.find("no odometry for"), std::string::npos);
  EXPECT_EQ(see(kSure).mode, Mode::kRepeating);
}

TEST_F(Supervisor, anImageThatComesLateLetsNothingMove) {
  startAndSee();
  double stamp_s = now_s_;
  EXPECT_EQ(watch(2.0, "image").mode, Mode::kStopped);
  for (int i = 0; i < 20; ++i) {
    stamp_s += 0.1;
    const NavigationStatus& status = supervisor_.see(stamp_s, travelled_m_, kSure, {});
    EXPECT_EQ(status.mode, Mode::kStopped);
    EXPECT_EQ(status.speed_factor, 0.0);
    EXPECT_NE(status.reason.find("no fresh image for"), std::string::npos) << status.reason;
    watch(0.1, "image");
    EXPECT_NE(supervisor_.status().reason.find("no fresh image for"), std::string::npos) << "the same reason";
  }
  EXPECT_EQ(see(kSure).mode, Mode::kRepeating);
}

TEST_F(Supervisor, givesUpWithoutData) {
  startAndSee();
  Mode mode = Mode::kRepeating;
  for (double silent_s = 0.0; silent_s < settings_.give_up_s + 1.0 && mode != Mode::kFailed;
       silent_s += 0.5) {
    mode = watch(0.5, "local map").mode;
  }
  EXPECT_EQ(mode, Mode::kFailed);
  EXPECT_NE(supervisor_.status().reason.find("no local map"), std::string::npos);
}

TEST_F(Supervisor, givesUpWhenNothingEverComes) {
  supervisor_.start(now_s_);
  EXPECT_EQ(watch(1.0, "image").mode, Mode::kStopped);
  for (int i = 0; i < 12; ++i) {
    watch(1.0, "image");
  }
  EXPECT_EQ(supervisor_.status().mode, Mode::kFailed);
}

TEST_F(Supervisor, aRobotThatPreparesIsNotSilentAndSaysWhatItDoes) {
  supervisor_.start(now_s_);
  for (int i = 0; i < 30; ++i) {
    now_s_ += 1.0;
    const NavigationStatus& status = supervisor_.prepare(now_s_, "looking for the place", {});
    ASSERT_EQ(status.mode, Mode::kStarting);
    EXPECT_EQ(status.reason, "looking for the place");
    EXPECT_EQ(status.speed_factor, 0.0);
  }
  EXPECT_EQ(watch(0.1, "image").reason, "looking for the place") << "until something is seen";
  EXPECT_EQ(watch(1.0, "image").mode, Mode::kStopped) << "afterwards silence counts again";
  supervisor_.trustPlace();
  EXPECT_EQ(see(kSure).mode, Mode::kRepeating);
}

TEST_F(Supervisor, preparingIsStoppedByWhatForbidsMotion) {
  supervisor_.start(now_s_);
  const MotionPermit stop{Kind::kStop, 0.0, "the emergency stop is engaged", {}};
  EXPECT_EQ(supervisor_.prepare(now_s_, "looking", stop).mode, Mode::kStopped);
  EXPECT_EQ(supervisor_.status().reason, stop.reason);
  EXPECT_EQ(supervisor_.prepare(now_s_, "looking", {}).mode, Mode::kStarting);
  EXPECT_EQ(supervisor_.prepare(now_s_ - 5.0, "looking", {}).mode, Mode::kFailed) << "time goes back";
}

TEST_F(Supervisor, nothingIsPreparedWithoutAGoal) {
  EXPECT_EQ(supervisor_.prepare(now_s_, "looking", {}).mode, Mode::kIdle);
}

TEST_F(Supervisor, unusableImagesStopAtOnceThenFail) {
  startAndSee();
  supervisor_.setImageProblem("the camera is frozen");
  EXPECT_EQ(watch(0.0).mode, Mode::kStopped);
  EXPECT_EQ(supervisor_.status().reason, "the camera is frozen");
  supervisor_.setImageProblem("");
  EXPECT_EQ(see(kSure).mode, Mode::kRepeating);
  supervisor_.setImageProblem("the camera is frozen");
  for (int i = 0; i < 12; ++i) {
    watch(1.0);
  }
  EXPECT_EQ(supervisor_.status().mode, Mode::kFailed);
}

TEST_F(Supervisor, timeThatGoesBackFails) {
  startAndSee();
  EXPECT_EQ(watch(-0.3).mode, Mode::kRepeating) << "clocks disagree a little";
  EXPECT_EQ(watch(-5.0).mode, Mode::kFailed);
  EXPECT_NE(supervisor_.status().reason.find("time went back"), std::string::npos);
}

TEST_F(Supervisor, timeThatJumpsForwardStopsButIsNoSilence) {
  startAndSee();
  EXPECT_EQ(watch(3600.0, "image").mode, Mode::kStopped) << "data from before is old";
  EXPECT_EQ(watch(0.1, "image").mode, Mode::kStopped);
  EXPECT_EQ(see(kSure).mode, Mode::kRepeating);
}

TEST_F(Supervisor, whatForbidsMotionStopsIt) {
  startAndSee();
  const MotionPermit stop{Kind::kStop, 0.0, "the emergency stop is engaged", {}};
  EXPECT_EQ(see(kSure, stop).mode, Mode::kStopped);
  EXPECT_EQ(supervisor_.status().reason, stop.reason);
  EXPECT_EQ(watch(0.05, "", stop).mode, Mode::kStopped);
  EXPECT_EQ(watch(0.05).mode, Mode::kRepeating);
}

TEST_F(Supervisor, pausesWhileAPersonDrives) {
  startAndSee();
  see(kBlind);
  const MotionPermit manual{Kind::kManual, 0.0, "driven by hand", {}};
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(see(kBlind, manual).mode, Mode::kStopped);
  }
  EXPECT_EQ(see(kBlind).mode, Mode::kDegraded) << "what a person drove does not count as blind";
}

TEST_F(Supervisor, obstaclesSlowThenHoldThenFail) {
  startAndSee();
  EXPECT_NEAR(see(kSure, {Kind::kGo, 0.5, "something is in the way", {}}).speed_factor, 0.5, 1e-12);
  EXPECT_EQ(supervisor_.status().mode, Mode::kRepeating);
  EXPECT_NEAR(see(kBlind, {Kind::kGo, 0.5, "", {}}).speed_factor, 0.5 * settings_.blind_speed, 1e-12);
  const MotionPermit hold{Kind::kHold, 0.0, "something is in the way, 0.3 m ahead", {}};
  EXPECT_EQ(see(kSure, hold).mode, Mode::kHolding);
  EXPECT_EQ(see(kSure).mode, Mode::kRepeating);
  for (int i = 0; i < 120; ++i) {
    see(kSure, hold);
  }
  EXPECT_EQ(supervisor_.status().mode, Mode::kFailed);
}

TEST_F(Supervisor, aStopWinsOverHolding) {
  startAndSee();
  driveBlindUntilHolding();
  const MotionPermit stop{Kind::kStop, 0.0, "somebody stopped it", {}};
  for (int i = 0; i < 300; ++i) {
    ASSERT_EQ(see(kBlind, stop).mode, Mode::kStopped) << "an emergency stop may take as long as it wants";
  }
  EXPECT_EQ(see(kBlind).mode, Mode::kHolding);
}

TEST_F(Supervisor, endsAndStartsAnew) {
  startAndSee();
  supervisor_.finish("done");
  EXPECT_EQ(supervisor_.status().mode, Mode::kFinished);
  EXPECT_EQ(see(kSure).mode, Mode::kFinished);
  startAndSee();
  supervisor_.rest("cancelled");
  EXPECT_EQ(supervisor_.status().mode, Mode::kIdle);
  startAndSee();
  supervisor_.fail("broken");
  EXPECT_EQ(supervisor_.status().mode, Mode::kFailed);
  now_s_ -= 500.0;
  startAndSee();
}

TEST(NavigationMode, hasNamesOfTheirOwn) {
  EXPECT_STREQ(nameOf(Mode::kIdle), "idle");
  EXPECT_STREQ(nameOf(Mode::kStarting), "starting");
  EXPECT_STREQ(nameOf(Mode::kRepeating), "repeating");
  EXPECT_STREQ(nameOf(Mode::kDegraded), "degraded");
  EXPECT_STREQ(nameOf(Mode::kHolding), "holding");
  EXPECT_STREQ(nameOf(Mode::kStopped), "stopped");
  EXPECT_STREQ(nameOf(Mode::kFinished), "finished");
  EXPECT_STREQ(nameOf(Mode::kFailed), "failed");
}

TEST(Sight, isWhatTheRegistrationSays) {
  RegistrationResult result;
  result.confidence = 0.3;
  EXPECT_FALSE(sightOf(result).recognised);
  result.displacement_px = 1.0;
  EXPECT_TRUE(sightOf(result).recognised);
  EXPECT_EQ(sightOf(result).confidence, 0.3);
}

TEST(SupervisorSettings, refusesWhatMakesNoSense) {
  ParameterReader reader({{"blind_speed", 0.0}});
  EXPECT_THROW(SupervisorSettings::load(reader), ParameterError);
}

}  // namespace
}  // namespace perennial
