#pragma once

#include <ros/time.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>

#include "perennial/core/repeat_session.h"
#include "perennial_nav/LocalMap.h"
#include "perennial_nav/RepeatGoal.h"

namespace perennial {

/// A goal of the action `repeat` being served.
struct RepeatRun {
  perennial_nav::RepeatGoal goal;
  std::unique_ptr<RepeatSession> session;  ///< from when the map has been opened
  std::size_t local_maps = 0;              ///< of the whole path
  std::uint32_t number = 1;                ///< of the current traversal, from 1
  double start_m = 0.0;                    ///< where along the path the current traversal began
  double begun_m = 0.0;                    ///< where the first one began
  double certainty = 0.0;                  ///< of that place, 0 to 1, if the robot found it by itself
  double driven_m = 0.0;                   ///< in the traversals before the current one
  double travelled_m = 0.0;                ///< by the odometer, at the newest image
  ros::Time started;                       ///< when the goal came
  std::size_t images_from_before = 0;      ///< left out, because their stamps lie before `started`
  std::size_t odometry_from_before = 0;    ///< likewise
  std::size_t images = 0;                  ///< registered, in all traversals
  std::size_t recognised = 0;              ///< of these: with a displacement
  double progress_m = 0.0;                 ///< travelled distance when the robot last moved
  ros::Time progress_stamp;
  std::map<std::uint32_t, perennial_nav::LocalMapConstPtr> messages;  ///< local maps held, for their images

  /// Place along the path; 0 before the map has been opened.
  double distance() const { return session ? session->distance(travelled_m) : 0.0; }
  bool atEnd() const { return session && session->atEnd(travelled_m); }

  void count(const NavigationStep& step) {
    ++images;
    recognised += step.registration.result.displacement_px ? 1 : 0;
  }

  /// Keeps a local map's message, the newest few of them.
  void keep(const perennial_nav::LocalMapConstPtr& message) {
    constexpr std::size_t kMessagesKept = 64;
    messages[message->index] = message;
    if (messages.size() > kMessagesKept) {
      messages.erase(messages.begin());
    }
  }
};

}  // namespace perennial
