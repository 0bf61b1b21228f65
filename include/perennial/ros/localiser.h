#pragma once

#include <ros/ros.h>
#include <sensor_msgs/Image.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "perennial/core/localisation.h"
#include "perennial/ros/traversal_client.h"

namespace perennial {

/// Finds the robot's place on the path of the open traversal: compares images with all its local maps, which
/// it asks map_manager for a few at a time. Between two pieces of that work other callbacks get their turn,
/// so that a goal can be cancelled meanwhile. All on the global queue; does not depend on ROS time.
class Localiser {
 public:
  struct Events {
    std::function<void()> progressed;  ///< with every image, and now and then
    /// An image has been compared: what Localisation::conclude() says.
    std::function<void(const sensor_msgs::ImageConstPtr& image, const std::optional<PlaceGuess>& place)>
        concluded;
    std::function<void(const std::string& reason)> failed;  ///< the manager does not give local maps
  };

  Localiser(const ros::NodeHandle& nh, TraversalClient& traversals, Events events);

  /// A place is wanted from now on; whatever was sought before is forgotten.
  void begin(const LocalisationSettings& settings, const RegistrationSettings& registration,
             std::size_t local_maps);
  /// No place is wanted any more.
  void end();

  /// Whether a place is wanted.
  bool active() const { return localisation_ != nullptr; }
  /// Whether an image is being compared; then no other one can be.
  bool searching() const { return image_ != nullptr; }

  /// Compares this image, which gave the features `view`.
  void look(const sensor_msgs::ImageConstPtr& image, FeatureSet view, double travelled_m);
  /// The image being compared; nullptr when there is none.
  const sensor_msgs::ImageConstPtr& image() const { return image_; }
  /// By the odometer, when the newest image was taken.
  double travelled() const { return travelled_m_; }
  /// What is being done, for a person.
  std::string progress() const { return localisation_->progress(); }

 private:
  void onTimer();
  void compareSome();

  TraversalClient& traversals_;
  Events events_;
  std::unique_ptr<Localisation> localisation_;
  sensor_msgs::ImageConstPtr image_;
  double travelled_m_ = 0.0;
  ros::WallTime begun_;  ///< comparing this image
  ros::WallTimer timer_;
};

}  // namespace perennial
