// Shows which way the navigator would steer, for somebody who connects a new robot: docs/your_robot.md.
#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/image_encodings.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <string>

#include "perennial/core/feature_extractor.h"
#include "perennial/core/registration.h"
#include "perennial/core/steering.h"
#include "perennial/ros/parameters.h"
#include "ros/node_main.h"

namespace {

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
/// image as it comes, so that a person can turn the robot and look.
struct Node {
  Node(ros::NodeHandle nh, const ros::NodeHandle& private_nh)
      : settings(perennial::loadNode<Settings>(private_nh, {})),
        navigator(settings.navigator),
        extractor(perennial::loadGroup<perennial::ExtractionSettings>(navigator, "extraction")),
        registration(perennial::makeRegistration(
            perennial::loadGroup<perennial::RegistrationSettings>(navigator, "registration"))),
        steering(perennial::loadGroup<perennial::SteeringSettings>(navigator, "steering")),
        subscriber(nh.subscribe("image", 1, &Node::onImage, this)) {}

  void onImage(const sensor_msgs::ImageConstPtr& message) {
    const cv::Mat image = cv_bridge::toCvShare(message, sensor_msgs::image_encodings::MONO8)->image;
    if (map.empty()) {
      map = extractor.extract(image);
      std::printf("The first image, with %zu features, is the map.\n", map.size());
      report("camera turned LEFT by arithmetic", extractor.extract(turnedLeft(image, settings.shift_px)));
      report("camera turned RIGHT by arithmetic", extractor.extract(turnedLeft(image, -settings.shift_px)));
      std::puts("Now turn the robot a little to the left: the navigator must turn it RIGHT.");
    } else if (message->header.stamp - last_report >= ros::Duration(0.5)) {
      last_report = message->header.stamp;
      report("now", extractor.extract(image));
    }
    std::fflush(stdout);
  }

  void report(const char* what, const perennial::FeatureSet& view) {
    const auto result = registration->registerView(map, view);
    if (!result.displacement_px) {
      std::printf("%s: nothing recognised (%d pairs agree)\n", what, result.inliers);
      return;
    }
    const double turn = perennial::steer({}, result.displacement_px, std::nullopt, steering).angular;
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
  perennial::FeatureSet map;
  ros::Time last_report;
  ros::Subscriber subscriber;
};

}  // namespace

int main(int argc, char** argv) { return perennial::runNode<Node>(argc, argv, "check_steering"); }
