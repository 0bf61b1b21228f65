#include "perennial/core/drivers/teleop.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace perennial {
namespace {

/// Shares of the full velocities.
const std::map<char, Velocity>& directions() {
  static const std::map<char, Velocity> kDirections = {
      {'u', {1.0, 1.0, 0.0}},  {'i', {1.0, 0.0, 0.0}},  {'o', {1.0, -1.0, 0.0}}, {'j', {0.0, 1.0, 0.0}},
      {'l', {0.0, -1.0, 0.0}}, {'m', {-1.0, 1.0, 0.0}}, {',', {-1.0, 0.0, 0.0}}, {'.', {-1.0, -1.0, 0.0}},
      {'r', {0.0, 0.0, 1.0}},  {'f', {0.0, 0.0, -1.0}},
  };
  return kDirections;
}

double axis(const std::vector<float>& axes, int index) {
  const auto position = static_cast<std::size_t>(index);
  const double value = position < axes.size() ? static_cast<double>(axes[position]) : 0.0;
  return std::isfinite(value) ? std::clamp(value, -1.0, 1.0) : 0.0;
}

}  // namespace

TeleopSettings TeleopSettings::load(ParameterReader& reader) {
  TeleopSettings settings;
  settings.forward_mps = reader.real("forward_mps", settings.forward_mps, 0.0, 10.0);
  settings.turn_radps = reader.real("turn_radps", settings.turn_radps, 0.0, 10.0);
  settings.flipper_radps = reader.real("flipper_radps", settings.flipper_radps, 0.0, 10.0);
  settings.key_timeout_s = reader.real("key_timeout_s", settings.key_timeout_s, 0.05, 5.0);
  settings.joy_timeout_s = reader.real("joy_timeout_s", settings.joy_timeout_s, 0.05, 5.0);
  settings.joy_deadman_button = reader.integer("joy_deadman_button", settings.joy_deadman_button, 0, 63);
  settings.joy_forward_axis = reader.integer("joy_forward_axis", settings.joy_forward_axis, 0, 63);
  settings.joy_turn_axis = reader.integer("joy_turn_axis", settings.joy_turn_axis, 0, 63);
  return settings;
}

void Teleop::key(char key, double now_s) {
  constexpr double kStep = 1.1;
  if (key == 'q' || key == 'z') {
    speed_factor_ = std::clamp(speed_factor_ * (key == 'q' ? kStep : 1.0 / kStep), 0.1, 5.0);
    return;
  }
  const auto direction = directions().find(key);
  if (direction == directions().end()) {
    wish_ = Wish{Velocity(), now_s + settings_.key_timeout_s};
    return;
  }
  const Velocity& share = direction->second;
  wish_ =
      Wish{{share.forward * settings_.forward_mps * speed_factor_,
            share.angular * settings_.turn_radps * speed_factor_, share.flipper * settings_.flipper_radps},
           now_s + settings_.key_timeout_s};
}

void Teleop::joy(const std::vector<float>& axes, const std::vector<int>& buttons, double now_s) {
  const auto button = static_cast<std::size_t>(settings_.joy_deadman_button);
  if (button >= buttons.size() || buttons[button] == 0) {
    wish_.reset();
    return;
  }
  wish_ = Wish{{axis(axes, settings_.joy_forward_axis) * settings_.forward_mps * speed_factor_,
                axis(axes, settings_.joy_turn_axis) * settings_.turn_radps * speed_factor_, 0.0},
               now_s + settings_.joy_timeout_s};
}

std::optional<Velocity> Teleop::velocity(double now_s) const {
  if (!wish_ || now_s > wish_->until_s) {
    return std::nullopt;
  }
  return wish_->velocity;
}

}  // namespace perennial
