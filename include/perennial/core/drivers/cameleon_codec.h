#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "perennial/core/path_profile.h"

/// The wire protocol of the CAMELEON E tracked robot: bytes to structures and back, for the driver and for
/// the simulator. Commands go to the robot as ten bytes without a header, the low byte of a magnitude first;
/// its status comes back as a header and 29 bytes, the high byte of an integer first.
namespace perennial {

/// What the driver tells the robot right after connecting: which of its parts it is going to use.
struct CameleonHandshake {
  bool drive = true;
  bool odometry = true;
  bool rotation = true;
  bool buttons = false;
};

enum class CameleonCommandType : std::uint8_t {
  kNone = 0,
  kStart = 1,
  kSpeed = 2,
  kEmpty = 3,
  kReset = 4,
  kStop = 5,
  kQuit = 6,
  kStatus = 7,
};

/// A command in the robot's own units. The magnitudes must lie within the limits below: behind its TCP
/// program the robot writes them with a fixed number of decimal digits and cuts off what does not fit.
struct CameleonCommand {
  CameleonCommandType type = CameleonCommandType::kNone;
  int forward = 0;
  int turn = 0;
  int flipper = 0;

  bool operator==(const CameleonCommand& other) const {
    return type == other.type && forward == other.forward && turn == other.turn && flipper == other.flipper;
  }
};

constexpr int kCameleonMaxForward = 9999;
constexpr int kCameleonMaxTurn = 999;
constexpr int kCameleonMaxFlipper = 47;

/// The robot's units for one SI unit. Those of turn and flipper are not certain, hence settings of the
/// driver.
struct CameleonScale {
  double forward_per_mps = 1000.0;
  double turn_per_radps = 1000.0;
  double flipper_per_radps = 1000.0;
};

struct CameleonStatus {
  bool valid = false;         ///< the robot vouches for the values
  std::int32_t left_mm = 0;   ///< odometer of the left track; wraps
  std::int32_t right_mm = 0;  ///< odometer of the right track; wraps
  std::int32_t pitch_deg = 0;
  std::int32_t roll_deg = 0;
  std::int32_t flipper_deg = 0;
  std::int32_t battery_percent = 0;

  bool operator==(const CameleonStatus& other) const {
    return valid == other.valid && left_mm == other.left_mm && right_mm == other.right_mm &&
           pitch_deg == other.pitch_deg && roll_deg == other.roll_deg && flipper_deg == other.flipper_deg &&
           battery_percent == other.battery_percent;
  }
};

constexpr std::size_t kCameleonHandshakeSize = 4;
constexpr std::size_t kCameleonCommandSize = 10;
constexpr std::size_t kCameleonStatusHeaderSize = 3;
constexpr std::size_t kCameleonStatusSize = 32;  ///< header and 29 bytes

using CameleonHandshakeBytes = std::array<std::uint8_t, kCameleonHandshakeSize>;
using CameleonCommandBytes = std::array<std::uint8_t, kCameleonCommandSize>;
using CameleonStatusBytes = std::array<std::uint8_t, kCameleonStatusSize>;

CameleonHandshakeBytes encode(const CameleonHandshake& handshake);
/// Nothing when a byte is neither 0 nor 1.
std::optional<CameleonHandshake> decodeHandshake(const CameleonHandshakeBytes& bytes);

/// Values beyond the limits of the robot are brought to the limit.
CameleonCommandBytes encode(const CameleonCommand& command);
/// Nothing for an unknown type or a sign byte other than 0 and 1.
std::optional<CameleonCommand> decodeCommand(const CameleonCommandBytes& bytes);

/// A speed command for a velocity, rounded to the nearest unit and within the robot's limits. A value that is
/// not finite becomes zero.
CameleonCommand toSpeedCommand(const Velocity& velocity, const CameleonScale& scale);
/// What a command asks for, in SI units.
Velocity toVelocity(const CameleonCommand& command, const CameleonScale& scale);

CameleonStatusBytes encode(const CameleonStatus& status);

}  // namespace perennial
