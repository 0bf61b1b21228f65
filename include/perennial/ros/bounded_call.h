#pragma once

#include <ros/ros.h>

#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "perennial/core/error.h"
#include "perennial/core/human_text.h"

namespace perennial {

/// Calls a service, but waits for at most `patience` of real time: roscpp itself waits for a node that hangs
/// for as long as it hangs. Throws MapError when there is no answer; the client is shut down if it hangs, for
/// a persistent connection would make the next call wait as well.
template <class Service>
void callWithin(const ros::WallDuration& patience, ros::ServiceClient& client, Service& service) {
  struct Call {
    ros::ServiceClient client;
    Service service;
    std::promise<bool> answered;
  };
  const auto call = std::make_shared<Call>(Call{client, service, {}});
  std::future<bool> answer = call->answered.get_future();
  // It outlives this function when the node hangs, until that answers or dies.
  std::thread([call] { call->answered.set_value(call->client.call(call->service)); }).detach();
  if (answer.wait_for(std::chrono::nanoseconds(patience.toNSec())) != std::future_status::ready) {
    const std::string name = client.getService();
    client.shutdown();
    throw MapError("map_manager is there, but has not answered on " + name + " for " +
                   humanSeconds(patience.toSec()) + ": it hangs; kill it, so that it is started anew");
  }
  if (!answer.get()) {
    throw MapError("map_manager does not answer on " + client.getService() + "; is it running?");
  }
  service = std::move(call->service);
}

}  // namespace perennial
