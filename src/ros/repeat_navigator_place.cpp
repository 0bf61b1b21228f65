// The part of the navigator that finds where on the path the robot is, for a goal with `localise`. The robot
// stands meanwhile: nothing here commands it.
#include <utility>

#include "perennial/core/error.h"
#include "perennial/core/human_text.h"
#include "perennial/ros/repeat_navigator.h"

namespace perennial {

void RepeatNavigator::beginLocalisation() {
  localiser_.begin(settings_.localisation, settings_.repeat.registration, run_->local_maps);
  prepare("waiting for an image and odometry, to look for the place");
}

/// While a person drives the robot, its place is not worth looking for, and what was seen before is of
/// elsewhere.
void RepeatNavigator::seekPlace(const sensor_msgs::ImageConstPtr& image, const cv::Mat& grey,
                                double travelled_m) {
  if (drivenByHand()) {
    beginLocalisation();
    return;
  }
  FeatureSet view;
  run_->session->extractInto(grey, view);
  localiser_.look(image, std::move(view), travelled_m);
}

void RepeatNavigator::onPlaceSought(const sensor_msgs::ImageConstPtr& image,
                                    const std::optional<PlaceGuess>& place) {
  if (drivenByHand()) {
    beginLocalisation();
  } else if (!place) {
    prepare("looking for the place; another image has to agree");
  } else if (place->sure) {
    startAt(*place, image->header.stamp);
  } else {
    fail("the robot's place was not found: " + place->reason);
  }
  acknowledge(image);
  processPending();
}

/// The manager sends the local maps from there on when the traversal is begun anew.
void RepeatNavigator::startAt(const PlaceGuess& place, const ros::Time& stamp) {
  localiser_.end();
  if (place.distance_m >= run_->session->length()) {
    fail("the robot stands at the end of the path, " + humanMetres(place.distance_m) +
         ": nothing is left to repeat");
    return;
  }
  try {
    traversals_.end(false, stamp);
    beginTraversal(place.distance_m, localiser_.travelled(), stamp);
  } catch (const Error& error) {
    fail(error.what());
    return;
  }
  supervisor_.trustPlace();
  run_->begun_m = place.distance_m;
  run_->certainty = place.certainty;
  const std::string found = place.reason + ", certainty " + humanPercent(place.certainty);
  ROS_INFO("the robot is %s", found.c_str());
  prepare("found: " + found + "; waiting for local maps");
}

/// The robot stands, and this is why.
void RepeatNavigator::prepare(const std::string& doing) {
  const ros::Time now = ros::Time::now();
  const NavigationStatus before = supervisor_.status();
  const NavigationStatus& status = supervisor_.prepare(now.toSec(), doing, gate_.permit());
  if (status.mode == NavigationMode::kFailed) {
    fail(status.reason);
  } else if (status.mode != before.mode || status.reason != before.reason) {
    publishState(now);
    publishFeedback();
  }
}

}  // namespace perennial
