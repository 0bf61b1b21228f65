#include "perennial/core/drivers/velocity_limiter.h"

#include <algorithm>
#include <cmath>

namespace perennial {
namespace {

double moveTowards(double current, double wanted, double largest_step) {
  return current + std::clamp(wanted - current, -largest_step, largest_step);
}

double approachForward(double current, double wanted, double elapsed_s, const VelocityLimits& limits) {
  const bool turns_back = current * wanted < 0.0;
  const bool brakes = turns_back || std::abs(wanted) < std::abs(current);
  return brakes ? moveTowards(current, turns_back ? 0.0 : wanted, limits.max_deceleration_mps2 * elapsed_s)
                : moveTowards(current, wanted, limits.max_acceleration_mps2 * elapsed_s);
}

}  // namespace

VelocityLimits VelocityLimits::load(ParameterReader& reader, VelocityLimits limits) {
  limits.max_forward_mps = reader.real("max_forward_mps", limits.max_forward_mps, 0.0, 9.999);
  limits.max_backward_mps = reader.real("max_backward_mps", limits.max_backward_mps, 0.0, 9.999);
  limits.max_turn_radps = reader.real("max_turn_radps", limits.max_turn_radps, 0.0, 10.0);
  limits.max_flipper_radps = reader.real("max_flipper_radps", limits.max_flipper_radps, 0.0, 10.0);
  limits.max_acceleration_mps2 =
      reader.real("max_acceleration_mps2", limits.max_acceleration_mps2, 0.01, 100.0);
  limits.max_deceleration_mps2 =
      reader.real("max_deceleration_mps2", limits.max_deceleration_mps2, 0.01, 100.0);
  limits.max_turn_acceleration_radps2 =
      reader.real("max_turn_acceleration_radps2", limits.max_turn_acceleration_radps2, 0.01, 100.0);
  return limits;
}

Velocity clampToLimits(const Velocity& wanted, const VelocityLimits& limits) {
  return {std::clamp(wanted.forward, -limits.max_backward_mps, limits.max_forward_mps),
          std::clamp(wanted.angular, -limits.max_turn_radps, limits.max_turn_radps),
          std::clamp(wanted.flipper, -limits.max_flipper_radps, limits.max_flipper_radps)};
}

Velocity approach(const Velocity& current, const Velocity& wanted, double elapsed_s,
                  const VelocityLimits& limits) {
  const Velocity target = clampToLimits(wanted, limits);
  const double elapsed = std::max(elapsed_s, 0.0);
  return {approachForward(current.forward, target.forward, elapsed, limits),
          moveTowards(current.angular, target.angular, limits.max_turn_acceleration_radps2 * elapsed),
          target.flipper};
}

}  // namespace perennial
