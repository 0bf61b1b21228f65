#include "perennial/ros/drivers/tara_camera_settings.h"

#include "perennial/core/error.h"

namespace perennial {
namespace {

std::uint8_t code(ParameterReader& reader, const std::string& key, std::uint8_t default_value,
                  std::uint8_t minimum, std::uint8_t maximum) {
  return static_cast<std::uint8_t>(reader.integer(key, default_value, minimum, maximum));
}

}  // namespace

TaraControls TaraControls::load(ParameterReader& reader) {
  TaraControls controls;
  controls.exposure_mode =
      reader.choice("exposure_mode", controls.exposure_mode, {"manual", "camera", "software"});
  controls.exposure = static_cast<std::uint32_t>(
      reader.integer("exposure", static_cast<int>(controls.exposure), kTaraMinExposure, kTaraMaxExposure));
  SoftwareExposureSettings& software = controls.software;
  software.target_brightness = reader.real("target_brightness", software.target_brightness, 1.0, 254.0);
  software.gain = reader.real("exposure_gain", software.gain, 0.0, 5.0);
  controls.brightness = reader.integer("brightness", controls.brightness, 1, 7);
  TaraImuSetup& imu = controls.imu;
  imu.mode = static_cast<TaraImuMode>(code(reader, "imu_mode", static_cast<std::uint8_t>(imu.mode), 0, 3));
  imu.rate = code(reader, "imu_rate", imu.rate, 1, 6);
  imu.accelerometer_range = code(reader, "accelerometer_range", imu.accelerometer_range, 0, 3);
  imu.gyroscope_range = code(reader, "gyroscope_range", imu.gyroscope_range, 0, 3);
  if (static_cast<int>(imu.mode) == 2) {
    throw ParameterError("parameter imu_mode is 2, but must be one of: 0, 1, 3");
  }
  if (imu.gyroscope_range == 2) {
    throw ParameterError("parameter gyroscope_range is 2, but must be one of: 0, 1, 3");
  }
  return controls;
}

TaraCameraSettings TaraCameraSettings::load(ParameterReader& reader) {
  TaraCameraSettings settings;
  settings.video_device = reader.text("video_device", settings.video_device);
  settings.serial = reader.text("serial", settings.serial);
  settings.sysfs_root = reader.text("sysfs_root", settings.sysfs_root);
  settings.dev_root = reader.text("dev_root", settings.dev_root);
  settings.width = reader.integer("width", settings.width, 16, 4096);
  settings.height = reader.integer("height", settings.height, 16, 4096);
  settings.frame_rate = reader.real("frame_rate", settings.frame_rate, 1.0, 120.0);
  settings.stall_timeout_s = reader.real("stall_timeout_s", settings.stall_timeout_s, 0.1, 60.0);
  settings.retry_period_s = reader.real("retry_period_s", settings.retry_period_s, 0.05, 60.0);
  settings.left_frame = reader.text("left_frame", settings.left_frame);
  settings.right_frame = reader.text("right_frame", settings.right_frame);
  settings.imu_frame = reader.text("imu_frame", settings.imu_frame);
  settings.left_info_url = reader.text("left_info_url", settings.left_info_url);
  settings.right_info_url = reader.text("right_info_url", settings.right_info_url);
  settings.controls = TaraControls::load(reader);
  return settings;
}

}  // namespace perennial
