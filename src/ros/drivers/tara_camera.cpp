#include "perennial/ros/drivers/tara_camera.h"

#include <ros/time.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/image_encodings.h>

#include <chrono>
#include <cstdio>

#include "perennial/core/drivers/tara_y16.h"
#include "perennial/core/error.h"

namespace perennial {
namespace {

constexpr double kSelectTimeout_s = 0.1;
constexpr std::chrono::milliseconds kImuSettling(100);

ros::Time stampOf(double age_s) {
  const ros::Time now = ros::Time::now();
  return ros::Time::isSimTime() || now.toSec() < age_s ? now : now - ros::Duration(age_s);
}

sensor_msgs::ImagePtr emptyImage(const TaraCameraSettings& settings, const std::string& frame,
                                 const ros::Time& stamp) {
  auto image = boost::make_shared<sensor_msgs::Image>();
  image->header.stamp = stamp;
  image->header.frame_id = frame;
  image->width = static_cast<std::uint32_t>(settings.width);
  image->height = static_cast<std::uint32_t>(settings.height);
  image->step = image->width;
  image->encoding = sensor_msgs::image_encodings::MONO8;
  image->data.resize(static_cast<std::size_t>(image->step) * image->height);
  return image;
}

std::string hexadecimal(std::uint32_t value) {
  char text[9];
  std::snprintf(text, sizeof text, "%08x", value);
  return text;
}

/// Whether the camera behind this control node has this unique id.
bool hasUniqueId(const std::string& control, const std::string& wanted) {
  try {
    TaraHid hid(control);
    const auto reply = hid.ask(taraUniqueIdRequest(), std::chrono::milliseconds(2000));
    const auto unique_id = reply ? decodeTaraUniqueId(*reply) : std::nullopt;
    return unique_id && hexadecimal(*unique_id) == wanted;
  } catch (const Error&) {
    return false;
  }
}

geometry_msgs::Vector3 toVector(const std::array<std::int16_t, 3>& raw, double unit) {
  geometry_msgs::Vector3 vector;
  vector.x = raw[0] * unit;
  vector.y = raw[1] * unit;
  vector.z = raw[2] * unit;
  return vector;
}

TaraControls toControls(const perennial_nav::TaraConfig& config) {
  TaraControls controls;
  controls.exposure_mode = config.exposure_mode;
  controls.exposure = static_cast<std::uint32_t>(config.exposure);
  controls.software.target_brightness = config.target_brightness;
  controls.software.gain = config.exposure_gain;
  controls.brightness = config.brightness;
  controls.imu.mode = static_cast<TaraImuMode>(config.imu_mode);
  controls.imu.rate = static_cast<std::uint8_t>(config.imu_rate);
  controls.imu.accelerometer_range = static_cast<std::uint8_t>(config.accelerometer_range);
  controls.imu.gyroscope_range = static_cast<std::uint8_t>(config.gyroscope_range);
  return controls;
}

}  // namespace

TaraCamera::View::View(ros::NodeHandle nh, image_transport::ImageTransport& transport,
                       const std::string& name, const std::string& frame, const std::string& info_url)
    : frame_id(frame),
      calibration(std::make_unique<camera_info_manager::CameraInfoManager>(ros::NodeHandle(nh, name),
                                                                           "tara_" + name, info_url)),
      publisher(transport.advertiseCamera(name + "/image_raw", 2)) {}

sensor_msgs::CameraInfoPtr TaraCamera::View::info(const sensor_msgs::Image& image) const {
  auto info = boost::make_shared<sensor_msgs::CameraInfo>(calibration->getCameraInfo());
  if (info->width != image.width || info->height != image.height) {
    if (info->width != 0) {
      ROS_WARN_ONCE("The calibration is for images of another size and is not published.");
    }
    *info = sensor_msgs::CameraInfo();
    info->width = image.width;
    info->height = image.height;
  }
  info->header = image.header;
  return info;
}

TaraCamera::TaraCamera(ros::NodeHandle nh, ros::NodeHandle private_nh, const TaraCameraSettings& settings)
    : settings_(settings),
      transport_(nh),
      left_(nh, transport_, "left", settings.left_frame, settings.left_info_url),
      right_(nh, transport_, "right", settings.right_frame, settings.right_info_url),
      imu_publisher_(nh.advertise<sensor_msgs::Imu>("imu", 100)),
      controls_(settings.controls),
      rate_since_s_(ros::SteadyTime::now().toSec()),
      diagnostics_(nh, private_nh),
      reconfigure_(private_nh) {
  diagnostics_.setHardwareID("TARA");
  diagnostics_.add("camera", this, &TaraCamera::diagnose);
  diagnostics_timer_ = nh.createWallTimer(
      ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { diagnostics_.force_update(); });
  reconfigure_.setCallback(
      [this](perennial_nav::TaraConfig& config, std::uint32_t) { onReconfigure(config); });
  thread_ = std::thread([this] { run(); });
}

TaraCamera::~TaraCamera() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    end_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

bool TaraCamera::ending() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return end_;
}

void TaraCamera::run() {
  while (!ending()) {
    std::string problem = "no camera found";
    try {
      if (const auto devices = findCamera()) {
        stream(*devices);
        problem = "the stream ended";
      }
    } catch (const Error& error) {
      problem = error.what();
    }
    closeHid();
    ROS_WARN_THROTTLE(10.0, "TARA: %s; looking for it every %.1f s.", problem.c_str(),
                      settings_.retry_period_s);
    std::unique_lock<std::mutex> lock(mutex_);
    problem_ = problem;
    changed_.wait_for(lock, std::chrono::duration<double>(settings_.retry_period_s), [this] { return end_; });
  }
}

std::optional<TaraDevices> TaraCamera::findCamera() const {
  for (const TaraDevices& devices : findTaraDevices(settings_.sysfs_root, settings_.dev_root)) {
    const bool right_path = settings_.video_device.empty() || devices.video == settings_.video_device;
    const bool right_serial = settings_.serial.empty() || devices.serial == settings_.serial ||
                              (!devices.control.empty() && hasUniqueId(devices.control, settings_.serial));
    if (right_path && right_serial) {
      return devices;
    }
  }
  return std::nullopt;
}

void TaraCamera::stream(const TaraDevices& devices) {
  V4l2Camera camera(devices.video, {settings_.width, settings_.height, settings_.frame_rate});
  openHid(devices);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    devices_ = devices;
    problem_.clear();
    controls_changed_ = true;
    ++counters_.starts;
  }
  sequence_.reset();
  ROS_INFO("TARA: streaming from %s.", devices.video.c_str());
  ros::SteadyTime last_image = ros::SteadyTime::now();
  while (!ending()) {
    applyControls(camera);
    const auto outcome =
        camera.grab(kSelectTimeout_s, [this](const V4l2Camera::Frame& frame) { publishFrame(frame); });
    if (outcome == V4l2Camera::Outcome::kLost) {
      throw Error(devices.video + " is gone");
    }
    if (outcome == V4l2Camera::Outcome::kFrame) {
      last_image = ros::SteadyTime::now();
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    counters_.short_frames += outcome == V4l2Camera::Outcome::kShortFrame ? 1 : 0;
    if ((ros::SteadyTime::now() - last_image).toSec() > settings_.stall_timeout_s) {
      ++counters_.stalls;
      throw Error("the stream of " + devices.video + " stalled");
    }
  }
}

void TaraCamera::openHid(const TaraDevices& devices) {
  std::shared_ptr<TaraControl> control;
  std::shared_ptr<TaraImu> imu;
  try {
    if (!devices.control.empty()) {
      control = std::make_shared<TaraControl>(devices.control);
    }
    if (!devices.imu.empty()) {
      imu = std::make_shared<TaraImu>(devices.imu,
                                      [this](const TaraImuReading& reading) { publishImu(reading); });
    }
  } catch (const Error& error) {
    ROS_ERROR("TARA: %s. Images come all the same, but the camera cannot be controlled.", error.what());
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  control_ = control;
  imu_ = imu;
}

void TaraCamera::closeHid() {
  std::shared_ptr<TaraControl> control;
  std::shared_ptr<TaraImu> imu;
  const std::lock_guard<std::mutex> lock(mutex_);
  control.swap(control_);
  imu.swap(imu_);
}

void TaraCamera::applyControls(V4l2Camera& camera) {
  TaraControls controls;
  std::shared_ptr<TaraControl> control;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!std::exchange(controls_changed_, false)) {
      return;
    }
    controls = controls_;
    control = control_;
    exposure_ = controls.exposure_mode == "camera" ? kTaraAutomaticExposure : controls.exposure;
  }
  software_exposure_.set(controls.software);
  if (!camera.setBrightness(controls.brightness)) {
    ROS_WARN("TARA: the brightness cannot be set.");
  }
  if (control) {
    control->setExposure(controls.exposure_mode == "camera" ? kTaraAutomaticExposure : controls.exposure);
    control->setImu(controls.imu);
  }
}

void TaraCamera::publishFrame(const V4l2Camera::Frame& frame) {
  const ros::Time stamp = stampOf(frame.age_s);
  const sensor_msgs::ImagePtr left = emptyImage(settings_, left_.frame_id, stamp);
  const sensor_msgs::ImagePtr right = emptyImage(settings_, right_.frame_id, stamp);
  splitY16(frame.words, left->data.size(), left->data.data(), right->data.data());
  left_.publisher.publish(left, left_.info(*left));
  right_.publisher.publish(right, right_.info(*right));
  adaptExposure(*left);
  const std::uint32_t missing = sequence_ ? frame.sequence - *sequence_ - 1 : 0;
  sequence_ = frame.sequence;
  const std::lock_guard<std::mutex> lock(mutex_);
  ++counters_.images;
  counters_.lost_frames += missing < 1000 ? missing : 0;
}

void TaraCamera::adaptExposure(const sensor_msgs::Image& left) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!control_ || controls_.exposure_mode != "software" || !software_exposure_.wantsImage()) {
    return;
  }
  const double mean = upperHalfMean(left.data.data(), left.width, left.height);
  if (const auto exposure = software_exposure_.next(mean, exposure_)) {
    exposure_ = *exposure;
    control_->setExposure(exposure_);
  }
}

void TaraCamera::publishImu(const TaraImuReading& reading) {
  std::shared_ptr<TaraControl> control;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++counters_.imu_readings;
    control = control_;
  }
  // The units are those of the set-up that the camera has confirmed. A report may still be of the one before.
  const auto state = control ? control->state() : TaraControl::State();
  if (!state.imu || std::chrono::steady_clock::now() - state.imu_since < kImuSettling) {
    return;
  }
  const TaraImuSetup& setup = *state.imu;
  sensor_msgs::Imu message;
  message.header.stamp = ros::Time::now();
  message.header.frame_id = settings_.imu_frame;
  message.orientation_covariance[0] = -1.0;  // there is none
  message.linear_acceleration =
      toVector(reading.acceleration, taraAccelerationUnit(setup.accelerometer_range));
  message.angular_velocity = toVector(reading.angular_rate, taraAngularRateUnit(setup.gyroscope_range));
  if (setup.mode != TaraImuMode::kBoth) {
    message.angular_velocity_covariance[0] = -1.0;
  }
  imu_publisher_.publish(message);
}

void TaraCamera::onReconfigure(perennial_nav::TaraConfig& config) {
  const std::lock_guard<std::mutex> lock(mutex_);
  // The generated checks know ranges only; these two have gaps in them.
  if (config.imu_mode == 2) {
    config.imu_mode = static_cast<int>(controls_.imu.mode);
  }
  if (config.gyroscope_range == 2) {
    config.gyroscope_range = controls_.imu.gyroscope_range;
  }
  controls_ = toControls(config);
  controls_changed_ = true;
}

void TaraCamera::diagnose(diagnostic_updater::DiagnosticStatusWrapper& report) {
  using Status = diagnostic_msgs::DiagnosticStatus;
  const std::lock_guard<std::mutex> lock(mutex_);
  const double now = ros::SteadyTime::now().toSec();
  const double rate =
      static_cast<double>(counters_.images - rate_images_) / std::max(now - rate_since_s_, 1e-3);
  rate_since_s_ = now;
  rate_images_ = counters_.images;
  const auto state = control_ ? control_->state() : TaraControl::State();
  if (!problem_.empty()) {
    report.summary(Status::ERROR, problem_);
  } else if (rate < 0.5 * settings_.frame_rate) {
    report.summary(Status::WARN, "few images");
  } else if (!control_ || state.failures > 0) {
    report.summary(Status::WARN,
                   control_ ? "requests to the camera failed" : "the camera cannot be controlled");
  } else {
    report.summary(Status::OK, "streaming");
  }
  report.add("video device", devices_.video);
  report.add("serial", devices_.serial);
  report.add("unique id", state.unique_id ? hexadecimal(*state.unique_id) : "unknown");
  report.add("firmware",
             state.firmware
                 ? std::to_string(state.firmware->major) + "." + std::to_string(state.firmware->minor) + "." +
                       std::to_string(state.firmware->sdk) + "." + std::to_string(state.firmware->svn)
                 : "unknown");
  report.add("exposure", state.exposure ? std::to_string(*state.exposure) : "unknown");
  report.add("image rate (1/s)", rate);
  report.add("images", counters_.images);
  report.add("short frames", counters_.short_frames);
  report.add("lost frames", counters_.lost_frames);
  report.add("stalls", counters_.stalls);
  report.add("starts", counters_.starts);
  report.add("inertial readings", counters_.imu_readings);
  report.add("bad inertial reports", imu_ ? imu_->badReports() : 0);
  report.add("failed requests", state.failures);
}

}  // namespace perennial
