#include "perennial/park/renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "perennial/park/park_layout.h"
#include "perennial/park/precipitation.h"

namespace perennial::park {
namespace {

constexpr double kExposure = 2.0;

class RendererTest : public testing::Test {
 protected:
  cv::Mat render(const Conditions& conditions, const CameraPose& pose, double exposure = kExposure) {
    return renderer_.render(conditions, pose, exposure).clone();
  }

  static bool same(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0.0; }

  /// Brightness in single precision.
  static cv::Mat grey(const cv::Mat& rendered) {
    cv::Mat channel, result;
    cv::extractChannel(rendered, channel, 3);
    channel.convertTo(result, CV_32F);
    return result;
  }

  /// How far the middle of `before` has moved to the right (x) and down (y) in `after`, px.
  static cv::Point movedBy(const cv::Mat& before, const cv::Mat& after) {
    const cv::Rect middle(276, 140, 200, 120);
    cv::Mat scores;
    cv::matchTemplate(grey(after), grey(before)(middle), scores, cv::TM_CCOEFF_NORMED);
    cv::Point best;
    cv::minMaxLoc(scores, nullptr, nullptr, nullptr, &best);
    return best - middle.tl();
  }

  LoopPath path_;
  CameraGeometry geometry_;
  Renderer renderer_{path_, geometry_};
  Conditions noon_;
};

TEST_F(RendererTest, sameSeedAndTimeGiveTheSameBytes) {
  CameraPose elsewhere;
  elsewhere.x = 2.0;
  elsewhere.heading = 1.0;
  Conditions evening = noon_;
  evening.date_time_s += 5.0 * 3600.0;
  const cv::Mat first = render(noon_, {});
  render(evening, elsewhere);  // Whatever comes between must leave no trace.
  EXPECT_TRUE(same(first, render(noon_, {})));
  Renderer another(path_, geometry_);
  EXPECT_TRUE(same(first, another.render(noon_, {}, kExposure)));
}

TEST_F(RendererTest, everyConditionChangesTheImage) {
  const cv::Mat reference = render(noon_, {});
  Conditions tomorrow = noon_, evening = noon_, overcast = noon_, windy = noon_, elsewhere = noon_;
  tomorrow.date_time_s += 86400.0;
  evening.date_time_s += 6.0 * 3600.0;
  overcast.weather = Weather::kOvercast;
  windy.wind_m_s = 8.0;
  elsewhere.world_seed = 2;
  for (const Conditions& other : {tomorrow, evening, overcast, windy, elsewhere}) {
    EXPECT_GT(cv::norm(reference, render(other, {}), cv::NORM_L1) / static_cast<double>(reference.total()),
              0.5);
  }
}

TEST_F(RendererTest, aCameraTurnedLeftSeesTheSceneMoveRightByTheFocalLength) {
  CameraPose turned;
  turned.heading = 0.1;
  const cv::Point moved = movedBy(render(noon_, {}), render(noon_, turned));
  EXPECT_NEAR(moved.x, geometry_.fx * std::tan(0.1), 3.0);
  EXPECT_NEAR(moved.y, 0, 2);
}

TEST_F(RendererTest, aCameraTurnedUpSeesTheSceneMoveDown) {
  CameraPose turned;
  turned.pitch = 0.1;
  const cv::Point moved = movedBy(render(noon_, {}), render(noon_, turned));
  EXPECT_NEAR(moved.y, geometry_.fy * std::tan(0.1), 3.0);
  EXPECT_NEAR(moved.x, 0, 2);
}

TEST_F(RendererTest, aCameraRolledRightSeesTheSceneRollLeft) {
  CameraPose rolled;
  rolled.roll = 0.05;
  const cv::Mat level = grey(render(noon_, {}));
  const cv::Mat tilted = grey(render(noon_, rolled));
  const cv::Point2f centre(static_cast<float>(geometry_.cx), static_cast<float>(geometry_.cy));
  const auto difference = [&](double angle_deg) {
    cv::Mat turned;
    // OpenCV's positive angles turn a picture counter-clockwise, that is left.
    cv::warpAffine(level, turned, cv::getRotationMatrix2D(centre, angle_deg, 1.0), level.size());
    const cv::Rect inside(100, 100, 552, 280);
    return cv::norm(turned(inside), tilted(inside), cv::NORM_L1);
  };
  const double degrees = 0.05 * 57.29577951308232;
  EXPECT_LT(difference(degrees), 0.6 * difference(-degrees));
  EXPECT_LT(difference(degrees), 0.6 * difference(0.0));
}

// The lamp post nearest to the start: where the pinhole model says that it stands, there is a thin vertical
// thing.
TEST_F(RendererTest, knownObjectsAppearWhereThePinholeModelSays) {
  const ParkLayout layout = makeLayout(path_, noon_.world_seed);
  int checked = 0;
  for (const Object& lamp : layout.furniture) {
    if (lamp.kind != ObjectKind::kLamp) {
      continue;
    }
    CameraPose pose;  // 4 m away, the post 0.6 m to the left of the axis
    pose.heading = lamp.pose.heading;
    pose.x = lamp.pose.x - 4.0 * std::cos(pose.heading) + 0.6 * std::sin(pose.heading);
    pose.y = lamp.pose.y - 4.0 * std::sin(pose.heading) - 0.6 * std::cos(pose.heading);
    Conditions night = noon_;  // The searchlight makes the near post stand out from the dark.
    night.date_time_s += 11.0 * 3600.0;
    const cv::Mat image = grey(render(night, pose, 300.0));
    const double column = geometry_.cx - geometry_.fx * 0.6 / 4.0;
    const cv::Mat strip = image(cv::Rect(static_cast<int>(column) - 40, 60, 81, 40));
    cv::Mat profile, gradient;
    cv::reduce(strip, profile, 0, cv::REDUCE_AVG);
    cv::Sobel(profile, gradient, CV_32F, 1, 0);
    const cv::Mat edges = cv::abs(gradient);
    double inside = 0.0, outside = 0.0;
    for (int i = 0; i < edges.cols; ++i) {
      double& largest = std::abs(i - 40) <= 9 ? inside : outside;
      largest = std::max(largest, static_cast<double>(edges.at<float>(i)));
    }
    checked += inside > outside ? 1 : 0;
  }
  EXPECT_GE(checked, 3) << "of four lamp posts, one may stand before bright things";
}

TEST_F(RendererTest, nightIsDarkWithoutTheSearchlight) {
  Conditions night = noon_;
  night.date_time_s += 11.0 * 3600.0;
  night.searchlight = Searchlight::kOff;
  const double largest_exposure = 800.0;
  const double dark = cv::mean(grey(render(night, {}, largest_exposure)))[0];
  night.searchlight = Searchlight::kOn;
  const double lit = cv::mean(grey(render(night, {}, largest_exposure)))[0];
  EXPECT_LT(dark, 25.0);
  EXPECT_GT(lit, 3.0 * dark);
}

TEST_F(RendererTest, rainAndSnowFallInFrontOfTheScene) {
  for (const Weather weather : {Weather::kRain, Weather::kSnow}) {
    Conditions conditions = noon_;
    conditions.weather = weather;
    const cv::Mat before = render(conditions, {});
    cv::Mat after = before.clone();
    drawPrecipitation(after, conditions, {}, geometry_, 0.005, kExposure);
    EXPECT_FALSE(same(before, after));
    cv::Mat again = before.clone();
    drawPrecipitation(again, conditions, {}, geometry_, 0.005, kExposure);
    EXPECT_TRUE(same(after, again));
  }
  cv::Mat dry = render(noon_, {});
  const cv::Mat copy = dry.clone();
  drawPrecipitation(dry, noon_, {}, geometry_, 0.005, kExposure);
  EXPECT_TRUE(same(dry, copy));
}

TEST(ParkLayout, leavesThePathFree) {
  const LoopPath path;
  for (int seed = 1; seed <= 5; ++seed) {
    const ParkLayout layout = makeLayout(path, seed);
    EXPECT_GT(layout.plants.size(), 150U);
    for (const Plant& plant : layout.plants) {
      EXPECT_GE(std::abs(path.nearest(plant.x, plant.y).lateral_m), 1.2);
    }
    for (const Object& object : layout.furniture) {
      EXPECT_GE(std::abs(path.nearest(object.pose.x, object.pose.y).lateral_m), 1.2);
    }
  }
}

TEST(ParkLayout, thingsComeAndGo) {
  const LoopPath path;
  const ParkLayout layout = makeLayout(path, 1);
  const auto places = [&](std::int64_t day) {
    std::vector<double> found;
    for (const Object& thing : thingsOfDay(layout, 1, day)) {
      found.push_back(thing.pose.x);
      EXPECT_GE(std::abs(path.nearest(thing.pose.x, thing.pose.y).lateral_m), 1.2);
    }
    return found;
  };
  EXPECT_EQ(places(20600), places(20600));
  int days_with_changes = 0;
  for (std::int64_t day = 20600; day < 20620; ++day) {
    days_with_changes += places(day) != places(day + 1) ? 1 : 0;
  }
  EXPECT_GE(days_with_changes, 10);
}

}  // namespace
}  // namespace perennial::park
