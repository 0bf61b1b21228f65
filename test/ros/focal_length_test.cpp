#include "perennial/ros/focal_length.h"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <limits>

namespace perennial {
namespace {

sensor_msgs::CameraInfoConstPtr calibration(double focal_length_px, std::uint32_t width) {
  const auto info = boost::make_shared<sensor_msgs::CameraInfo>();
  info->K[0] = focal_length_px;
  info->width = width;
  return info;
}

TEST(FocalLength, isScaledToTheImagesWidth) {
  EXPECT_DOUBLE_EQ(*focalLength(calibration(600.0, 752), 752), 600.0);
  EXPECT_DOUBLE_EQ(*focalLength(calibration(600.0, 752), 376), 300.0);
}

TEST(FocalLength, countsAsUnknownWhereItCannotBe) {
  EXPECT_FALSE(focalLength(nullptr, 752));
  EXPECT_FALSE(focalLength(calibration(0.0, 752), 752)) << "what uncalibrated drivers send";
  EXPECT_FALSE(focalLength(calibration(-600.0, 752), 752));
  EXPECT_FALSE(focalLength(calibration(600.0, 0), 752));
  EXPECT_FALSE(focalLength(calibration(std::numeric_limits<double>::quiet_NaN(), 752), 752));
  EXPECT_FALSE(focalLength(calibration(std::numeric_limits<double>::infinity(), 752), 752));
}

}  // namespace
}  // namespace perennial
