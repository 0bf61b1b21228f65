#include "perennial/ros/traversal_client.h"

#include <utility>

#include "perennial/core/error.h"
#include "perennial/ros/bounded_call.h"
#include "perennial/ros/conversions.h"
#include "perennial_nav/BeginTraversal.h"
#include "perennial_nav/EndTraversal.h"
#include "perennial_nav/GetLocalMaps.h"

namespace perennial {
namespace {

/// A manager that was started just now is connected within a fraction of a second. Real time.
const ros::WallDuration kListenerPatience(5.0);
const ros::WallDuration kListenerPoll(0.05);
/// Of the manager's answers, real time. A map of an older format is migrated when it is opened.
const ros::WallDuration kBeginPatience(300.0);
const ros::WallDuration kPatience(20.0);

}  // namespace

TraversalClient::TraversalClient(ros::NodeHandle nh) : nh_(std::move(nh)) {
  const auto connected = [this](const ros::SingleSubscriberPublisher& listener) {
    listeners_.insert(listener.getSubscriberName());
  };
  const auto gone = [this](const ros::SingleSubscriberPublisher& listener) {
    const auto entry = listeners_.find(listener.getSubscriberName());
    if (entry != listeners_.end()) {
      listeners_.erase(entry);
    }
  };
  ros::AdvertiseOptions options = ros::AdvertiseOptions::create<perennial_nav::Registration>(
      "registration", 1000, connected, gone, ros::VoidConstPtr(), &listeners_queue_);
  publisher_ = nh_.advertise(options);
}

perennial_nav::BeginTraversalResponse TraversalClient::begin(const std::string& map, double start_m,
                                                             const ros::Time& stamp) {
  perennial_nav::BeginTraversal service;
  service.request.map_name = map;
  service.request.start_distance_m = start_m;
  service.request.stamp = stamp;
  if (!begin_.isValid()) {
    begin_ = nh_.serviceClient<perennial_nav::BeginTraversal>("begin_traversal");
  }
  callWithin(kBeginPatience, begin_, service);
  if (!service.response.success) {
    throw MapError(service.response.message);
  }
  if (!end_.isValid()) {
    end_ = nh_.serviceClient<perennial_nav::EndTraversal>("end_traversal", true);
  }
  open_ = true;
  id_ = service.response.traversal;
  registrations_ = 0;
  awaitListener(service.response.node);
  return service.response;
}

std::vector<ActiveMap> TraversalClient::localMaps(std::size_t first, std::size_t count, bool with_edges) {
  if (!local_maps_.isValid()) {
    local_maps_ = nh_.serviceClient<perennial_nav::GetLocalMaps>("get_local_maps", true);
  }
  perennial_nav::GetLocalMaps service;
  service.request.traversal = id_;
  service.request.first = static_cast<std::uint32_t>(first);
  service.request.count = static_cast<std::uint32_t>(count);
  service.request.with_edges = static_cast<std::uint8_t>(with_edges);
  callWithin(kPatience, local_maps_, service);
  if (!service.response.success) {
    throw MapError(service.response.message);
  }
  std::vector<ActiveMap> maps;
  maps.reserve(service.response.maps.size());
  for (const perennial_nav::LocalMap& message : service.response.maps) {
    maps.push_back(fromMessage(message));
  }
  return maps;
}

void TraversalClient::awaitListener(const std::string& node) {
  const ros::WallTime last = ros::WallTime::now() + kListenerPatience;
  for (listeners_queue_.callAvailable(); listeners_.count(node) == 0;) {
    if (!ros::ok() || ros::WallTime::now() > last) {
      throw MapError(node + " answers on " + begin_.getService() + ", but does not listen to " +
                     publisher_.getTopic() + "; is the topic remapped for one of the two only?");
    }
    listeners_queue_.callAvailable(kListenerPoll);
  }
}

void TraversalClient::publish(perennial_nav::Registration registration) {
  registration.traversal = id_;
  publisher_.publish(registration);
  ++registrations_;
}

std::uint32_t TraversalClient::end(bool commit, const ros::Time& stamp) {
  if (!open_) {
    return 0;
  }
  open_ = false;
  perennial_nav::EndTraversal service;
  service.request.traversal = id_;
  service.request.registrations = registrations_;
  service.request.commit = static_cast<std::uint8_t>(commit);
  service.request.stamp = stamp;
  callWithin(kPatience, end_, service);
  if (!service.response.success && commit) {
    throw MapError("this traversal was not learned from: " + service.response.message);
  }
  return service.response.updated_maps;
}

}  // namespace perennial
