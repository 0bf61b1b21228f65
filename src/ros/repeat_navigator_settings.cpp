#include "perennial/ros/repeat_navigator_settings.h"

#include <xmlrpcpp/XmlRpcValue.h>

#include <string>
#include <vector>

#include "perennial/core/error.h"
#include "perennial/ros/parameters.h"

namespace perennial {
namespace {

const std::vector<std::string> kGroups{"extraction",   "registration", "steering",   "along_path",
                                       "localisation", "odometer",     "supervisor", "limits",
                                       "dead_man",     "obstacles",    "teleop"};

/// Of a robot of which nothing is known.
const VelocityLimits kLimits{1.5, 1.5, 1.5, 10.0, 2.0, 4.0, 5.0};

/// The defaults know nothing of who watches over this robot. A node that is started anew after the master
/// was, and found none of what the launch file had set, must not drive with them.
void requireParameters(const ros::NodeHandle& private_nh) {
  XmlRpc::XmlRpcValue all;
  const bool set = private_nh.getParam(private_nh.getNamespace(), all) &&
                   all.getType() == XmlRpc::XmlRpcValue::TypeStruct && all.size() > 0;
  if (!set) {
    throw ParameterError("none of the parameters of " + private_nh.getNamespace() +
                         " is set; a ROS master that was restarted has forgotten them: start the launch file "
                         "anew. To run with the defaults on purpose, set one: _every_image:=false");
  }
}

VelocityLimits loadLimits(const ros::NodeHandle& private_nh) {
  ParameterReader reader = groupReader(private_nh, "limits");
  const VelocityLimits limits = VelocityLimits::load(reader, kLimits);
  reader.requireAllUsed();
  return limits;
}

}  // namespace

RepeatNavigatorSettings RepeatNavigatorSettings::load(ParameterReader& reader) {
  RepeatNavigatorSettings settings;
  settings.every_image = reader.boolean("every_image", settings.every_image);
  settings.sensor_timeout_s = reader.real("sensor_timeout_s", settings.sensor_timeout_s, 0.05, 3600.0);
  settings.give_up_s = reader.real("give_up_s", settings.give_up_s, 0.1, 1e9);
  settings.stall_timeout_s = reader.real("stall_timeout_s", settings.stall_timeout_s, 0.0, 3600.0);
  return settings;
}

RepeatNavigatorSettings RepeatNavigatorSettings::load(const ros::NodeHandle& private_nh) {
  requireParameters(private_nh);
  RepeatNavigatorSettings settings = loadNode<RepeatNavigatorSettings>(private_nh, kGroups);
  settings.repeat = {loadGroup<ExtractionSettings>(private_nh, "extraction"),
                     loadGroup<RegistrationSettings>(private_nh, "registration"),
                     loadGroup<SteeringSettings>(private_nh, "steering"),
                     loadGroup<AlongPathSettings>(private_nh, "along_path")};
  settings.odometer = loadGroup<OdometerSettings>(private_nh, "odometer");
  settings.localisation = loadGroup<LocalisationSettings>(private_nh, "localisation");
  settings.supervisor = loadGroup<SupervisorSettings>(private_nh, "supervisor");
  settings.supervisor.sensor_timeout_s = settings.sensor_timeout_s;
  settings.supervisor.give_up_s = settings.give_up_s;
  settings.limits = loadLimits(private_nh);
  settings.interlock = {loadGroup<DeadManSettings>(private_nh, "dead_man"),
                        loadGroup<ObstacleSettings>(private_nh, "obstacles"),
                        loadGroup<OverrideSettings>(private_nh, "teleop")};
  return settings;
}

}  // namespace perennial
