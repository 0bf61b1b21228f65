#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "perennial/core/map_manager.h"
#include "perennial/ros/strategy_loader.h"
#include "perennial_nav/BeginTraversal.h"
#include "perennial_nav/EndTraversal.h"
#include "perennial_nav/GetLocalMaps.h"
#include "perennial_nav/LocalMap.h"
#include "perennial_nav/Registration.h"

namespace perennial {

/// Parameters of the node itself; groups: management, and one named like the strategy for its own parameters.
struct MapManagerNodeSettings {
  std::string map_folder;           ///< where maps are stored; required
  std::string strategy = "static";  ///< name of the plugin

  static MapManagerNodeSettings load(ParameterReader& reader);
};

/// Owns the map file: opens a map for a traversal (service begin_traversal), publishes local_maps ahead of
/// the robot, learns from registration, and stores or forgets what was learned (service end_traversal). To a
/// robot that looks for its place it gives any local maps (service get_local_maps).
///
/// Two threads: services are served by one of their own, because end_traversal waits for the registrations
/// that are still on their way; everything else runs on the global queue. One mutex guards all state.
class MapManagerNode {
 public:
  /// Throws ParameterError, among others for a strategy that does not exist.
  MapManagerNode(ros::NodeHandle nh, ros::NodeHandle private_nh);
  ~MapManagerNode();

 private:
  bool onBegin(perennial_nav::BeginTraversalRequest& request,
               perennial_nav::BeginTraversalResponse& response);
  bool onEnd(perennial_nav::EndTraversalRequest& request, perennial_nav::EndTraversalResponse& response);
  bool onGet(perennial_nav::GetLocalMapsRequest& request, perennial_nav::GetLocalMapsResponse& response);
  void onRegistration(const perennial_nav::RegistrationConstPtr& message);
  void onSubscriber(const ros::SingleSubscriberPublisher& subscriber);

  /// In the present format, when the map can be migrated; else without learning.
  void beginTraversal(double stamp_s);
  void open(const perennial_nav::BeginTraversalRequest& request,
            perennial_nav::BeginTraversalResponse& response);
  void learn(const perennial_nav::Registration& message);
  void publishDue(double distance_m);
  perennial_nav::LocalMap messageWithoutImage(std::uint32_t index, bool with_edges) const;
  perennial_nav::LocalMap message(std::uint32_t index) const;
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);

  ros::NodeHandle nh_;
  ros::NodeHandle private_nh_;
  MapManagerNodeSettings settings_;
  MapManagerSettings manager_settings_;
  StrategyLoader loader_;
  std::shared_ptr<MapStrategy> strategy_;

  std::mutex mutex_;
  std::condition_variable registration_came_;
  std::unique_ptr<MapManager> manager_;
  std::uint32_t traversal_ = 0;      ///< identifies the open traversal towards the navigator
  std::uint32_t registrations_ = 0;  ///< received in it
  std::uint32_t window_begin_ = 0;   ///< local maps published around the robot, for late subscribers
  std::uint32_t window_end_ = 0;
  ros::Time stamp_;
  std::string problem_;  ///< why this traversal can teach nothing; empty: it can

  ros::Publisher map_publisher_;
  ros::Subscriber registration_subscriber_;
  diagnostic_updater::Updater diagnostics_;
  ros::Timer diagnostics_timer_;
  ros::CallbackQueue service_queue_;
  ros::ServiceServer begin_server_;
  ros::ServiceServer end_server_;
  ros::ServiceServer get_server_;
  ros::AsyncSpinner service_spinner_;
};

}  // namespace perennial
