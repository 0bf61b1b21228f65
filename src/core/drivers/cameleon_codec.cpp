#include "perennial/core/drivers/cameleon_codec.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace perennial {
namespace {

/// Magnitude, low byte first, and a byte that is 1 for a negative value.
void putMagnitude(int value, int limit, std::uint8_t* bytes) {
  const int limited = std::clamp(value, -limit, limit);
  const int magnitude = std::abs(limited);
  bytes[0] = static_cast<std::uint8_t>(magnitude & 0xFF);
  bytes[1] = static_cast<std::uint8_t>((magnitude >> 8) & 0xFF);
  bytes[2] = static_cast<std::uint8_t>(limited < 0);
}

std::optional<int> magnitude(const std::uint8_t* bytes) {
  if (bytes[2] > 1) {
    return std::nullopt;
  }
  const int value = bytes[0] | (bytes[1] << 8);
  return bytes[2] == 1 ? -value : value;
}

int toUnits(double value, double scale, int limit) {
  const double units = value * scale;
  if (!std::isfinite(units)) {
    return 0;
  }
  return static_cast<int>(std::lround(std::clamp(units, -1.0 * limit, 1.0 * limit)));
}

void putInteger(std::int32_t value, std::uint8_t* bytes) {
  const auto bits = static_cast<std::uint32_t>(value);
  for (int i = 0; i < 4; ++i) {
    bytes[i] = static_cast<std::uint8_t>(bits >> (24 - 8 * i));
  }
}

}  // namespace

CameleonHandshakeBytes encode(const CameleonHandshake& handshake) {
  const auto bit = [](bool value) { return static_cast<std::uint8_t>(value ? 1 : 0); };
  return {bit(handshake.drive), bit(handshake.odometry), bit(handshake.rotation), bit(handshake.buttons)};
}

std::optional<CameleonHandshake> decodeHandshake(const CameleonHandshakeBytes& bytes) {
  if (std::any_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte > 1; })) {
    return std::nullopt;
  }
  return CameleonHandshake{bytes[0] == 1, bytes[1] == 1, bytes[2] == 1, bytes[3] == 1};
}

CameleonCommandBytes encode(const CameleonCommand& command) {
  CameleonCommandBytes bytes{};
  bytes[0] = static_cast<std::uint8_t>(command.type);
  putMagnitude(command.forward, kCameleonMaxForward, &bytes[1]);
  putMagnitude(command.turn, kCameleonMaxTurn, &bytes[4]);
  putMagnitude(command.flipper, kCameleonMaxFlipper, &bytes[7]);
  return bytes;
}

std::optional<CameleonCommand> decodeCommand(const CameleonCommandBytes& bytes) {
  const std::optional<int> forward = magnitude(&bytes[1]);
  const std::optional<int> turn = magnitude(&bytes[4]);
  const std::optional<int> flipper = magnitude(&bytes[7]);
  if (bytes[0] > static_cast<std::uint8_t>(CameleonCommandType::kStatus) || !forward || !turn || !flipper) {
    return std::nullopt;
  }
  return CameleonCommand{static_cast<CameleonCommandType>(bytes[0]), *forward, *turn, *flipper};
}

CameleonCommand toSpeedCommand(const Velocity& velocity, const CameleonScale& scale) {
  return {CameleonCommandType::kSpeed, toUnits(velocity.forward, scale.forward_per_mps, kCameleonMaxForward),
          toUnits(velocity.angular, scale.turn_per_radps, kCameleonMaxTurn),
          toUnits(velocity.flipper, scale.flipper_per_radps, kCameleonMaxFlipper)};
}

Velocity toVelocity(const CameleonCommand& command, const CameleonScale& scale) {
  return {command.forward / scale.forward_per_mps, command.turn / scale.turn_per_radps,
          command.flipper / scale.flipper_per_radps};
}

CameleonStatusBytes encode(const CameleonStatus& status) {
  CameleonStatusBytes bytes{0xF0, 0xAF, 0xFA, 7};
  const std::array<std::int32_t, 7> values = {status.valid ? 1 : 0,  status.left_mm,  status.right_mm,
                                              status.pitch_deg,      status.roll_deg, status.flipper_deg,
                                              status.battery_percent};
  for (std::size_t i = 0; i < values.size(); ++i) {
    putInteger(values[i], &bytes[4 + 4 * i]);
  }
  return bytes;
}

}  // namespace perennial
