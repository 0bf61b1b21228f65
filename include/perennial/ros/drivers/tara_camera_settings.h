#pragma once

#include <string>

#include "perennial/core/drivers/software_exposure.h"
#include "perennial/core/drivers/tara_hid_codec.h"
#include "perennial/core/parameter_reader.h"

namespace perennial {

/// What may change while the camera runs (dynamic_reconfigure).
struct TaraControls {
  std::string exposure_mode = "software";  ///< manual, camera or software
  std::uint32_t exposure = kTaraDefaultExposure;
  SoftwareExposureSettings software;
  int brightness = 4;
  TaraImuSetup imu;

  static TaraControls load(ParameterReader& reader);
};

struct TaraCameraSettings {
  std::string video_device;  ///< empty: the first camera found, or that with this serial
  std::string serial;        ///< of the USB device, or the camera's unique id in hexadecimal
  std::string sysfs_root = "/sys";
  std::string dev_root = "/dev";
  int width = 752;
  int height = 480;
  double frame_rate = 30.0;
  double stall_timeout_s = 2.0;  ///< after so long without a picture the stream is started anew
  double retry_period_s = 1.0;   ///< how often a camera that is not there is looked for
  std::string left_frame = "tara_left";
  std::string right_frame = "tara_right";
  std::string imu_frame = "tara_imu";
  std::string left_info_url;
  std::string right_info_url;
  TaraControls controls;

  static TaraCameraSettings load(ParameterReader& reader);
};

}  // namespace perennial
