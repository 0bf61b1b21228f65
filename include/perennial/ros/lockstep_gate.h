#pragma once

#include <geometry_msgs/Twist.h>
#include <ros/time.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "perennial_nav/Processed.h"

namespace perennial {

/// Keeps simulated (or recorded) time in step with the nodes that process images: after an image, time may go
/// on only when each of them has said on `processed` that it is done, and when the command that it announced
/// there has arrived. Thus a slow machine gives the same result as a fast one.
///
///     gate.expect(image.header.stamp);
///     publish(image);
///     serve callbacks until gate.open(), or give up
///
/// Knows no clock, topic or thread: feed it messages; not thread-safe.
class LockstepGate {
 public:
  /// `through_drivers`: images and commands pass through drivers of hardware, which stamp images by their own
  /// idea of the moment and change commands. Then an answer counts when its stamp is later than the last
  /// image's, and no command is waited for.
  explicit LockstepGate(const std::vector<std::string>& nodes, bool through_drivers = false);

  /// An image of this stamp goes out now.
  void expect(const ros::Time& stamp);
  void onProcessed(const perennial_nav::Processed& message);
  void onCommand(const geometry_msgs::Twist& command);

  bool open() const { return missing().empty(); }
  /// What is waited for, for a person: names of nodes, or "the command of NODE".
  std::vector<std::string> missing() const;
  /// Stops waiting for this image. A node that has not answered is not waited for again until it answers an
  /// image, so that one that died or has not started yet delays but once.
  void giveUp();

 private:
  bool answers(const ros::Time& stamp) const;

  std::set<std::string> nodes_;
  bool through_drivers_;
  std::set<std::string> absent_;  ///< given up on
  std::set<std::string> pending_;
  ros::Time stamp_;
  ros::Time last_stamp_;                           ///< of the image before
  std::optional<geometry_msgs::Twist> newest_;     ///< command that arrived
  std::optional<geometry_msgs::Twist> announced_;  ///< command that must arrive
  std::string announced_by_;
};

}  // namespace perennial
