#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosbag/bag.h>

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "perennial/core/parameter_reader.h"
#include "perennial_nav/Processed.h"

namespace perennial {

struct BagPlayerSettings {
  std::string bag;                ///< file; required
  std::string mode = "teach";     ///< "teach" a map from the bag, or "repeat" against one
  std::string map_name;           ///< required
  bool overwrite = false;         ///< teach: replace a map of this name
  double start_distance_m = 0.0;  ///< repeat: where along the path the bag begins
  bool localise = false;          ///< repeat: that place is found by the images instead
  std::string image_topic = "/camera/image_raw";
  std::string odom_topic = "/odom";
  std::string command_topic = "/cmd_vel";  ///< the one that drove; see BagPlayer
  double patience_s = 30.0;                ///< real time to wait for the nodes before giving up

  static BagPlayerSettings load(ParameterReader& reader);
};

/// Plays a bag to the teach recorder or the repeat navigator as fast as they keep up, losing no image: it
/// publishes /clock from the bag's time and goes on only while no more than a few images are unanswered on
/// `processed`. Sends the goal before the first message and ends it after the last. One thread.
///
/// Moves no robot: the bag's commands are published on `bag/cmd_vel`, in mode repeat not at all (there the
/// navigator publishes its own), and other velocities of the bag never.
class BagPlayer {
 public:
  /// Throws ParameterError, and Error for a bag that cannot be read or lacks the image or odometry topic.
  BagPlayer(ros::NodeHandle nh, ros::NodeHandle private_nh);

  /// Plays it all; true when the map was taught or the path repeated. Throws Error when the nodes do not
  /// answer.
  bool run();

  /// Serves callbacks until `done`; false after `seconds` of real time.
  bool waitUntil(const std::function<bool()>& done, double seconds);

  /// Stamp of the last image that the nodes worked on as part of the goal.
  ros::Time newestAnswered() const { return newest_answered_; }
  const BagPlayerSettings& settings() const { return settings_; }

 private:
  bool teach();
  bool repeat();
  void requireTopics() const;
  void advertise();
  void publishClock(const ros::Time& time);
  /// Says how it went; returns `success`.
  bool ended(bool success, const std::string& message) const;
  /// A message played before the node works on the goal would be lost.
  void awaitStart(const std::function<bool()>& started);
  /// `stop`: asked between messages whether playing on makes no sense.
  void play(const std::function<bool()>& stop);
  void onProcessed(const perennial_nav::Processed& message);

  ros::NodeHandle nh_;
  BagPlayerSettings settings_;
  rosbag::Bag bag_;
  std::string node_;  ///< the one that must answer
  std::map<std::string, ros::Publisher> publishers_;
  ros::Publisher clock_publisher_;
  ros::Subscriber processed_subscriber_;
  std::set<ros::Time> unanswered_;
  ros::Time clock_;
  ros::Time newest_answered_;
  std::size_t images_ = 0;
};

}  // namespace perennial
