#pragma once

#include <camera_info_manager/camera_info_manager.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <dynamic_reconfigure/server.h>
#include <image_transport/image_transport.h>
#include <ros/node_handle.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "perennial/ros/drivers/tara_camera_settings.h"
#include "perennial/ros/drivers/tara_control.h"
#include "perennial/ros/drivers/tara_devices.h"
#include "perennial/ros/drivers/tara_imu.h"
#include "perennial/ros/drivers/v4l2_camera.h"
#include "perennial_nav/TaraConfig.h"

namespace perennial {

/// Publishes the TARA's two views, its inertial sensor and its diagnostics; finds the camera again whenever
/// it is unplugged and plugged in, or its stream stalls.
///
/// Stamps: the kernel tells by its monotonic clock when a picture was taken. Its age by that clock is
/// subtracted from ROS time, at the moment at which the picture is fetched; so the stamps follow the system's
/// time even where that is adjusted. In simulated time an age in real seconds means nothing and is left out.
///
/// Pictures come on a thread of their own, requests to the camera go out on TaraControl's, inertial data
/// comes on TaraImu's, everything else runs on the spinning thread.
class TaraCamera {
 public:
  TaraCamera(ros::NodeHandle nh, ros::NodeHandle private_nh, const TaraCameraSettings& settings);
  ~TaraCamera();

 private:
  struct View {
    View(ros::NodeHandle nh, image_transport::ImageTransport& transport, const std::string& name,
         const std::string& frame, const std::string& info_url);
    sensor_msgs::CameraInfoPtr info(const sensor_msgs::Image& image) const;

    std::string frame_id;
    std::unique_ptr<camera_info_manager::CameraInfoManager> calibration;
    image_transport::CameraPublisher publisher;
  };
  struct Counters {
    std::uint64_t images = 0;
    std::uint64_t short_frames = 0;
    std::uint64_t lost_frames = 0;  ///< missing in the kernel's numbering
    std::uint64_t imu_readings = 0;
    std::uint64_t starts = 0;
    std::uint64_t stalls = 0;
  };

  void run();
  std::optional<TaraDevices> findCamera() const;
  void stream(const TaraDevices& devices);
  void openHid(const TaraDevices& devices);
  void closeHid();
  void applyControls(V4l2Camera& camera);
  void publishFrame(const V4l2Camera::Frame& frame);
  void adaptExposure(const sensor_msgs::Image& left);
  void publishImu(const TaraImuReading& reading);
  void onReconfigure(perennial_nav::TaraConfig& config);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& report);
  bool ending() const;

  const TaraCameraSettings settings_;
  image_transport::ImageTransport transport_;
  View left_;
  View right_;
  ros::Publisher imu_publisher_;

  mutable std::mutex mutex_;  ///< guards what follows, down to the next blank line
  std::condition_variable changed_;
  bool end_ = false;
  TaraControls controls_;
  bool controls_changed_ = true;
  std::string problem_ = "not started";  ///< empty while pictures come
  TaraDevices devices_;
  Counters counters_;
  std::uint32_t exposure_ = 0;
  std::shared_ptr<TaraControl> control_;
  std::shared_ptr<TaraImu> imu_;

  SoftwareExposure software_exposure_;     ///< of the capturing thread
  std::optional<std::uint32_t> sequence_;  ///< of the capturing thread
  double rate_since_s_;
  std::uint64_t rate_images_ = 0;
  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer diagnostics_timer_;
  dynamic_reconfigure::Server<perennial_nav::TaraConfig> reconfigure_;
  std::thread thread_;
};

}  // namespace perennial
