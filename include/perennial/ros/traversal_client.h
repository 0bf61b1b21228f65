#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "perennial/core/active_map.h"
#include "perennial_nav/BeginTraversalResponse.h"
#include "perennial_nav/Registration.h"

namespace perennial {

/// The navigator's side of the conversation with map_manager: opens and ends traversals, publishes the
/// registrations and counts them, so that the manager can wait for all. Calls block until the manager
/// answers; one that hangs for 20 s, or 300 s where a map is opened, counts as gone. Throws MapError with the
/// manager's reason, or when no manager answers.
class TraversalClient {
 public:
  explicit TraversalClient(ros::NodeHandle nh);

  /// Returns when the manager is connected to `registration`, so that it will miss none.
  perennial_nav::BeginTraversalResponse begin(const std::string& map, double start_m, const ros::Time& stamp);
  /// Nothing happens when no traversal is open. Returns how many local maps learned something.
  std::uint32_t end(bool commit, const ros::Time& stamp);

  /// Local maps of the open traversal from index `first` on, at most `count` of them; none behind the path's
  /// end. With their edges to drive by them, without to look for a place.
  std::vector<ActiveMap> localMaps(std::size_t first, std::size_t count, bool with_edges);

  /// `registration.traversal` is filled in.
  void publish(perennial_nav::Registration registration);
  bool open() const { return open_; }
  /// Whether the manager that opened the traversal is still there: its connection, kept open, tells at once.
  /// True while no traversal is open.
  bool managerAlive() const { return !open_ || end_.isValid(); }
  /// Identifies the open traversal; local maps of any other one are stale.
  std::uint32_t id() const { return id_; }

 private:
  void awaitListener(const std::string& node);

  ros::NodeHandle nh_;
  ros::CallbackQueue listeners_queue_;
  std::multiset<std::string> listeners_;  ///< nodes that are connected to `registration`
  ros::Publisher publisher_;
  ros::ServiceClient begin_;
  ros::ServiceClient local_maps_;   ///< persistent once it was needed
  mutable ros::ServiceClient end_;  ///< persistent while a traversal is open
  bool open_ = false;
  std::uint32_t id_ = 0;
  std::uint32_t registrations_ = 0;
};

}  // namespace perennial
