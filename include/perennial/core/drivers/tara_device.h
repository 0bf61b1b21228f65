#pragma once

#include <cstdint>

#include "perennial/core/drivers/tara_hid_codec.h"

namespace perennial {

/// The camera's side of the HID reports, for simulation. Not thread-safe.
class TaraDevice {
 public:
  /// The reply to a request; empty for one that the camera does not know. imuReading() is what a request for
  /// values gets.
  TaraReply answer(const TaraRequest& request);

  /// A report with these readings.
  static TaraReply imuReport(const TaraImuReading& reading);

  std::uint32_t exposure() const { return exposure_; }
  const TaraImuSetup& imuSetup() const { return imu_; }
  bool imuStreams() const { return imu_streams_ && imu_.mode != TaraImuMode::kOff; }
  /// A camera that lies still, level: gravity along z.
  TaraImuReading imuReading() const;

 private:
  std::uint32_t exposure_ = kTaraDefaultExposure;
  TaraImuSetup imu_{TaraImuMode::kOff, 7, 3, 0, 7, 0};
  bool imu_streams_ = false;
  std::uint8_t stream_mode_ = 0;
};

}  // namespace perennial
