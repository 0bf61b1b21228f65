#include "perennial/ros/traversal_client.h"

#include <utility>

#include "perennial/core/error.h"
#include "perennial_nav/BeginTraversal.h"
#include "perennial_nav/EndTraversal.h"

namespace perennial {

TraversalClient::TraversalClient(ros::NodeHandle nh)
    : nh_(std::move(nh)), begin_(nh_.serviceClient<perennial_nav::BeginTraversal>("begin_traversal")) {}

perennial_nav::BeginTraversalResponse TraversalClient::begin(const std::string& map, double start_m,
                                                             const ros::Time& stamp) {
  perennial_nav::BeginTraversal service;
  service.request.map_name = map;
  service.request.start_distance_m = start_m;
  service.request.stamp = stamp;
  if (!begin_.call(service)) {
    throw MapError("map_manager does not answer on " + begin_.getService() + "; is it running?");
  }
  if (!service.response.success) {
    throw MapError(service.response.message);
  }
  if (!end_.isValid()) {
    end_ = nh_.serviceClient<perennial_nav::EndTraversal>("end_traversal", true);
  }
  open_ = true;
  id_ = service.response.traversal;
  registrations_ = 0;
  return service.response;
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
  if (!end_.call(service)) {
    throw MapError("map_manager does not answer on " + end_.getService());
  }
  if (!service.response.success && commit) {
    throw MapError("this traversal was not learned from: " + service.response.message);
  }
  return service.response.updated_maps;
}

}  // namespace perennial
