#include <ros/ros.h>

#include <exception>
#include <filesystem>
#include <iostream>
#include <optional>

#include "perennial/core/error.h"
#include "perennial/ros/bag_player.h"
#include "perennial/ros/parameters.h"
#include "perennial/ros/registration_recorder.h"

namespace {

using perennial::BagPlayer;
using perennial::RegistrationRecorder;
using perennial::RegistrationRecorderSettings;

constexpr double kPatience_s = 10.0;

/// What the nodes are set to, as far as results depend on it.
perennial::RunSettings runSettings(const ros::NodeHandle& nh) {
  std::string strategy = "unknown";
  nh.getParam("map_manager/strategy", strategy);
  perennial::RunSettings run(strategy);
  const auto add = [&](const std::string& group, const std::string& prefix) {
    for (const auto& [key, value] : perennial::readParameters(ros::NodeHandle(nh, group))) {
      run.set(prefix + key + "=" + perennial::toText(value));
    }
  };
  add("map_manager/" + strategy, "");
  add("map_manager/management", "map_manager/");
  add("repeat_navigator/registration", "registration/");
  add("repeat_navigator/extraction", "extraction/");
  return run;
}

bool play(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh) {
  const auto evaluation = perennial::loadGroup<RegistrationRecorderSettings>(private_nh, "evaluation");
  BagPlayer player(nh, private_nh);
  // On a master that goes on, parameters of an evaluation before may still be there when a map is taught.
  if (evaluation.folder.empty() || player.settings().mode != "repeat") {
    return player.run();
  }
  RegistrationRecorder recorder(nh, evaluation);
  if (!player.waitUntil([&] { return recorder.isConnected(); }, player.settings().patience_s)) {
    throw perennial::Error("nobody publishes registrations");
  }
  const bool success = player.run();
  // They come on a connection of their own, perhaps after the news that all is done.
  player.waitUntil([&] { return recorder.hasReached(player.newestAnswered()); }, kPatience_s);
  recorder.write(std::filesystem::path(player.settings().bag).stem().string(), runSettings(nh));
  return success;
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "bag_player");
  try {
    return play(ros::NodeHandle(), ros::NodeHandle("~")) ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "bag_player: " << error.what() << std::endl;
    return 1;
  }
}
