#include "perennial/park/camera_model.h"

#include <gtest/gtest.h>

#include <cmath>

namespace perennial::park {
namespace {

/// What the renderer would give of an evenly lit wall with a bright line in it.
cv::Mat rendered(const CameraModel& camera, double radiance) {
  const double light = std::min(1.0, radiance * camera.exposure() / Renderer::kEncodedWhite);
  const double value = std::round(255.0 * std::sqrt(light));
  return cv::Mat(480, 752, CV_8UC4, cv::Scalar::all(value));
}

double mean(const cv::Mat& image) { return cv::mean(image)[0]; }

TEST(CameraModel, exposureConvergesOverFiveDecades) {
  CameraModel camera({}, 1);
  for (const double radiance : {0.3, 0.0005, 0.02, 1.0, 0.0005, 0.2}) {
    cv::Mat image;
    for (int i = 0; i < 40; ++i) {
      image = camera.develop(rendered(camera, radiance), 0.0, i, false);
    }
    EXPECT_NEAR(mean(image) / 255.0, camera.settings().target_brightness, 0.05) << radiance;
    EXPECT_TRUE(camera.state().settled) << radiance;
  }
}

TEST(CameraModel, raisesTheGainOnlyWhenTheTimeIsUsedUp) {
  CameraModel camera({}, 1);
  for (int i = 0; i < 40; ++i) {
    camera.develop(rendered(camera, 0.1), 0.0, i, false);
  }
  EXPECT_EQ(camera.state().gain, 1.0);
  EXPECT_LT(camera.state().time_ms, camera.settings().exposure_max_ms);
  for (int i = 0; i < 60; ++i) {
    camera.develop(rendered(camera, 1e-7), 0.0, i, false);
  }
  EXPECT_EQ(camera.state().time_ms, camera.settings().exposure_max_ms);
  EXPECT_NEAR(20.0 * std::log10(camera.state().gain), camera.settings().gain_max_db, 1e-6);
}

TEST(CameraModel, saturates) {
  CameraModel camera({}, 1);
  EXPECT_NEAR(mean(camera.develop(cv::Mat(480, 752, CV_8UC4, cv::Scalar::all(255)), 0.0, 1, false)), 255.0,
              1e-9);
}

TEST(CameraModel, noiseIsSeededAndGrowsWithTheGain) {
  CameraModel one({}, 1), same({}, 1), other({}, 2);
  const cv::Mat input(480, 752, CV_8UC4, cv::Scalar::all(100));
  const cv::Mat image = one.develop(input, 0.0, 5, false);
  EXPECT_EQ(cv::norm(image, same.develop(input, 0.0, 5, false), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(image, other.develop(input, 0.0, 5, false), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(image, CameraModel({}, 1).develop(input, 0.0, 6, false), cv::NORM_INF), 0.0);

  const auto deviation = [](const cv::Mat& picture) {
    cv::Scalar average, result;
    cv::meanStdDev(picture, average, result);
    return result[0];
  };
  CameraModel night({}, 1);
  for (int i = 0; i < 60; ++i) {
    night.develop(rendered(night, 1e-7), 0.0, i, false);
  }
  EXPECT_GT(deviation(night.develop(input, 0.0, 5, false)), 2.0 * deviation(image));
  CameraSettings clean;
  clean.noise = 0.0;
  EXPECT_EQ(deviation(CameraModel(clean, 1).develop(input, 0.0, 5, false)), 0.0);
}

TEST(CameraModel, turningBlursHorizontally) {
  CameraSettings settings;
  settings.noise = 0.0;
  CameraModel camera(settings, 1);
  cv::Mat line(480, 752, CV_8UC4, cv::Scalar::all(40));
  line.col(376).setTo(cv::Scalar::all(180));
  const double turn_rate = 10.0 / (settings.geometry.fx * camera.state().time_ms * 1e-3);  // 10 px long
  const cv::Mat image = camera.develop(line, turn_rate, 1, false);
  const unsigned char background = image.at<unsigned char>(200, 300);
  EXPECT_GT(image.at<unsigned char>(200, 376 + 4), background);
  EXPECT_GT(image.at<unsigned char>(200, 376 - 4), background);
  EXPECT_EQ(image.at<unsigned char>(200, 376 + 7), background);
  EXPECT_EQ(image.at<unsigned char>(200, 376 - 7), background);
}

TEST(CameraModel, loadsAFieldOfView) {
  ParameterReader reader({{"horizontal_fov_deg", 90.0}, {"width", 640}, {"height", 480}});
  const CameraGeometry geometry = CameraSettings::load(reader).geometry;
  EXPECT_NEAR(geometry.fx, 320.0, 1e-9);
  EXPECT_EQ(geometry.cx, 319.5);
}

}  // namespace
}  // namespace perennial::park
