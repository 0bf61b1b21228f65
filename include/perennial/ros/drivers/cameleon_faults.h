#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "perennial/core/drivers/cameleon_codec.h"

namespace perennial {

/// What is wrong with what the simulated robot sends, and for how long. Times are the simulator's, s.
struct CameleonFaults {
  int stray_bytes = 0;           ///< random bytes before the next status
  int half_frame_bytes = 0;      ///< of the next status only so many bytes are sent
  int wrong_types = 0;           ///< so many statuses have another type
  int wrong_validities = 0;      ///< so many statuses have a validity of 2
  double silent_until_s = 0.0;   ///< no status is sent
  double frozen_until_s = 0.0;   ///< the robot's program does nothing at all, the connection stays
  double refused_until_s = 0.0;  ///< nobody can connect
  double latency_s = 0.0;        ///< statuses and commands arrive so much later

  /// The bytes to send for this status; faults that last for some frames are counted down.
  std::vector<std::uint8_t> distort(const CameleonStatus& status, std::mt19937& random);
};

}  // namespace perennial
