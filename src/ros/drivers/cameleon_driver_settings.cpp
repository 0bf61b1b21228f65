#include "perennial/ros/drivers/cameleon_driver.h"

namespace perennial {

CameleonDriverSettings CameleonDriverSettings::load(ParameterReader& reader) {
  CameleonDriverSettings settings;
  settings.link = CameleonLinkSettings::load(reader);
  CameleonScale& scale = settings.scale;
  scale.forward_per_mps = reader.real("forward_per_mps", scale.forward_per_mps, 1.0, 1e5);
  scale.turn_per_radps = reader.real("turn_per_radps", scale.turn_per_radps, 1.0, 1e5);
  scale.flipper_per_radps = reader.real("flipper_per_radps", scale.flipper_per_radps, 1.0, 1e5);
  settings.limits = VelocityLimits::load(reader);
  settings.odometry = TrackOdometrySettings::load(reader);
  settings.frames.odom = reader.text("odom_frame", settings.frames.odom);
  settings.frames.base = reader.text("base_frame", settings.frames.base);
  settings.frames.flipper_joint = reader.text("flipper_joint", settings.frames.flipper_joint);
  settings.command_rate_hz = reader.real("command_rate_hz", settings.command_rate_hz, 2.0, 25.0);
  settings.command_timeout_s = reader.real("command_timeout_s", settings.command_timeout_s, 0.05, 10.0);
  settings.command_settle_s = reader.real("command_settle_s", settings.command_settle_s, 0.0, 10.0);
  settings.status_timeout_s = reader.real("status_timeout_s", settings.status_timeout_s, 0.2, 60.0);
  settings.master_timeout_s = reader.real("master_timeout_s", settings.master_timeout_s, 0.5, 60.0);
  settings.battery_low_percent = reader.real("battery_low_percent", settings.battery_low_percent, 0.0, 100.0);
  settings.publish_tf = reader.boolean("publish_tf", settings.publish_tf);
  return settings;
}

}  // namespace perennial
