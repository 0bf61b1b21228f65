// Shows which way the navigator would steer, for somebody who connects a new robot: docs/your_robot.md.
#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/image_encodings.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>

#include "perennial/core/feature_extractor.h"
#include "perennial/core/registration.h"
#include "perennial/core/steering.h"
#include "perennial/ros/focal_length.h"
#include "perennial/ros/parameters.h"
#include "ros/node_main.h"

namespace {

/// Cameras send their calibration with each image.
const ros::WallDuration kInfoPatience(2.0);

struct Settings {
  int shift_px = 40;
  std::string navigator =
      "/repeat_navigator";  ///< whose parameters for extraction, registration and steering are used
  static Settings load(perennial::ParameterReader& reader) {
    Settings settings;
    settings.shift_px = reader.integer("shift_px", settings.shift_px, 1, 1000);
    settings.navigator = reader.text("navigator", settings.navigator);
    return settings;
  }
};

/// The image as a camera sees it that was turned to the left: the scene moves to the right.
cv::Mat turnedLeft(const cv::Mat& image, int shift_px) {
  const cv::Matx23d move(1.0, 0.0, shift_px, 0.0, 1.0, 0.0);
  cv::Mat turned;
  cv::warpAffine(image, turned, move, image.size());
  return turned;
}

/// Registers and steers as the navigator would: with its parameters where they are set, the defaults where
/// not. The first image is the map. Its own copies, turned by arithmetic, are registered once; every further
/// image as it comes, so that a person can turn the robot and look. The calibration counts where there is
/// one: it is waited for a moment.
struct Node {
  Node(ros::NodeHandle nh, const ros::NodeHandle& private_nh)
      : settings(perennial::loadNode<Settings>(private_nh, {})),
        navigator(settings.navigator),
        extractor(perennial::loadGroup<perennial::ExtractionSettings>(navigator, "extraction")),
        registration(perennial::makeRegistration(
            perennial::loadGroup<perennial::RegistrationSettings>(navigator, "registration"))),
        steering(perennial::loadGroup<perennial::SteeringSettings>(navigator, "steering")),
        info_subscriber(nh.subscribe("camera_info", 1, &Node::onCameraInfo, this)),
        subscriber(nh.subscribe("image", 1, &Node::onImage, this)) {
    patience = nh.createWallTimer(
        kInfoPatience, [this](const ros::WallTimerEvent&) { begin(); }, true, false);
  }

  void onCameraInfo(const sensor_msgs::CameraInfoConstPtr& message) {
    info = message;
    begin();
  }

  void onImage(const sensor_msgs::ImageConstPtr& message) {
    const cv::Mat image = cv_bridge::toCvShare(message, sensor_msgs::image_encodings::MONO8)->image;
    if (first.empty()) {
      first = image.clone();
      map = extractor.extract(first);
      info ? begin() : patience.start();
    } else if (begun && message->header.stamp - last_report >= ros::Duration(0.5)) {
      last_report = message->header.stamp;
      report("now", extractor.extract(image));
    }
    std::fflush(stdout);
  }

  /// Once the first image is there, and the calibration or nobody to send one.
  void begin() {
    if (begun || first.empty()) {
      return;
    }
    begun = true;
    std::printf("The first image, with %zu features, is the map; %s.\n", map.size(), gain().c_str());
    report("camera turned LEFT by arithmetic", extractor.extract(turnedLeft(first, settings.shift_px)));
    report("camera turned RIGHT by arithmetic", extractor.extract(turnedLeft(first, -settings.shift_px)));
    std::puts("Now turn the robot a little to the left: the navigator must turn it RIGHT.");
    std::fflush(stdout);
  }

  std::string gain() const {
    const std::optional<double> focal_px = perennial::focalLength(info, first.cols);
    return focal_px ? "gain_per_rad counts, with a focal length of " +
                          std::to_string(std::lround(*focal_px)) + " px by " + info_subscriber.getTopic()
                    : "gain_per_px counts, for nothing comes on " + info_subscriber.getTopic();
  }

  void report(const char* what, const perennial::FeatureSet& view) {
    const auto result = registration->registerView(map, view);
    if (!result.displacement_px) {
      std::printf("%s: nothing recognised (%d pairs agree)\n", what, result.inliers);
      return;
    }
    const double turn =
        perennial::steer({}, result.displacement_px, perennial::focalLength(info, first.cols), steering)
            .angular;
    const char* way = std::abs(*result.displacement_px) < 1.0 ? "go straight on"
                      : turn > 0.0                            ? "turn LEFT"
                                                              : "turn RIGHT";
    std::printf("%s: displacement %+.1f px, %d pairs agree: would %s, angular.z %+.3f rad/s\n", what,
                *result.displacement_px, result.inliers, way, turn);
  }

  Settings settings;
  ros::NodeHandle navigator;
  perennial::FeatureExtractor extractor;
  std::unique_ptr<perennial::Registration> registration;
  perennial::SteeringSettings steering;
  cv::Mat first;
  perennial::FeatureSet map;
  bool begun = false;
  sensor_msgs::CameraInfoConstPtr info;
  ros::WallTimer patience;
  ros::Time last_report;
  ros::Subscriber info_subscriber;
  ros::Subscriber subscriber;
};

}  // namespace

int main(int argc, char** argv) { return perennial::runNode<Node>(argc, argv, "check_steering"); }
