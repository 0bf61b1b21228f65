#include "perennial/ros/drivers/tara_simulator.h"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>
#include <std_msgs/UInt32.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "perennial/core/drivers/tara_hid_codec.h"
#include "perennial/core/error.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

constexpr double kPatternPeriod_s = 1.0 / 30.0;

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

/// A device of a class, as in sysfs: its `device` leads to the folder of the interface that it belongs to.
void addClassDevice(const fs::path& sysfs, const std::string& name, const fs::path& interface) {
  const fs::path device = sysfs / "class" / name;
  fs::create_directories(device);
  fs::create_directory_symlink(interface, device / "device");
}

/// The part of /sys and /dev that the driver looks at.
void plugIn(const fs::path& folder) {
  const fs::path sysfs = folder / "sys";
  const fs::path usb = sysfs / "devices" / "usb1" / "1-1";
  write(usb / "idVendor", "2560\n");
  write(usb / "idProduct", "c114\n");
  write(usb / "serial", "SIMULATED\n");
  fs::create_directories(usb / "1-1:1.0");
  write(usb / "1-1:1.2" / "0003:2560:C114.0001" / "report_descriptor",
        std::string(kTaraControlDescriptorSize, '\0'));
  write(usb / "1-1:1.3" / "0003:2560:C114.0002" / "report_descriptor",
        std::string(kTaraImuDescriptorSize, '\0'));
  addClassDevice(sysfs, "video4linux/video0", usb / "1-1:1.0");
  write(sysfs / "class" / "video4linux" / "video0" / "index", "0\n");
  addClassDevice(sysfs, "video4linux/video1", usb / "1-1:1.0");
  write(sysfs / "class" / "video4linux" / "video1" / "index", "1\n");
  addClassDevice(sysfs, "hidraw/hidraw0", usb / "1-1:1.2" / "0003:2560:C114.0001");
  addClassDevice(sysfs, "hidraw/hidraw1", usb / "1-1:1.3" / "0003:2560:C114.0002");
  for (const char* name : {"video0", "video1", "hidraw0", "hidraw1"}) {
    write(folder / "dev" / name, "");
  }
}

}  // namespace

TaraSimulatorSettings TaraSimulatorSettings::load(ParameterReader& reader) {
  TaraSimulatorSettings settings;
  settings.folder = reader.text("folder", settings.folder);
  settings.width = reader.integer("width", settings.width, 16, 752);
  settings.height = reader.integer("height", settings.height, 16, 480);
  settings.from_topic = reader.boolean("from_topic", settings.from_topic);
  settings.disparity_px = reader.integer("disparity_px", settings.disparity_px, 0, 200);
  if (settings.folder.empty()) {
    throw ParameterError("parameter folder is missing: where the simulated devices go");
  }
  return settings;
}

TaraSimulator::TaraSimulator(ros::NodeHandle nh, ros::NodeHandle private_nh,
                             const TaraSimulatorSettings& settings)
    : settings_(settings),
      exposure_publisher_(private_nh.advertise<std_msgs::UInt32>("exposure", 1, true)),
      brightness_publisher_(private_nh.advertise<std_msgs::UInt32>("brightness", 1, true)) {
  std::error_code error;
  fs::create_directories(settings_.folder, error);
  world_ = &mapTaraWorld(settings_.folder, true);
  world_->width = static_cast<std::uint32_t>(settings_.width);
  world_->height = static_cast<std::uint32_t>(settings_.height);
  world_->triggered = settings_.from_topic ? 1 : 0;
  plug(true);
  defineFaults();
  fault_service_ = private_nh.advertiseService("inject_fault", &TaraSimulator::injectFault, this);
  if (settings_.from_topic) {
    image_subscriber_ =
        nh.subscribe("image", 5, &TaraSimulator::onImage, this, ros::TransportHints().tcpNoDelay());
  } else {
    pattern_timer_ = nh.createWallTimer(ros::WallDuration(kPatternPeriod_s),
                                        [this](const ros::WallTimerEvent&) { showPattern(); });
  }
  state_timer_ =
      nh.createWallTimer(ros::WallDuration(0.05), [this](const ros::WallTimerEvent&) { publishState(); });
}

TaraSimulator::~TaraSimulator() {
  world_->unplugged = 1;
  std::error_code error;
  for (const std::string name : {"sys", "dev", "world"}) {
    fs::remove_all(fs::path(settings_.folder) / name, error);
  }
  fs::remove(settings_.folder, error);  // only when nothing else lies there
}

void TaraSimulator::plug(bool in) {
  const fs::path folder(settings_.folder);
  world_->unplugged = in ? 0 : 1;
  fs::remove_all(folder / "dev");
  fs::remove_all(folder / "sys");
  if (in) {
    plugIn(fs::absolute(folder));
  }
}

void TaraSimulator::defineFaults() {
  const auto number = [](double value) { return static_cast<std::uint32_t>(std::max(value, 0.0)); };
  fault_setters_ = {
      {"unplugged", [=](double value) { plug(value == 0.0); }},
      {"stalled", [=](double value) { world_->stalled = number(value); }},
      {"short_frames", [=](double value) { world_->short_frames = number(value); }},
      {"hid_silent", [=](double value) { world_->hid_silent = number(value); }},
      {"hid_nonsense", [=](double value) { world_->hid_nonsense = number(value); }},
  };
}

bool TaraSimulator::injectFault(perennial_nav::InjectFault::Request& request,
                                perennial_nav::InjectFault::Response& response) {
  const auto setter = fault_setters_.find(request.fault);
  if (setter == fault_setters_.end() || !(std::abs(request.value) < 1e9)) {
    response.message = "the faults, each with a value (0: over), are:";
    for (const auto& [name, unused] : fault_setters_) {
      response.message += " " + name;
    }
    return true;
  }
  setter->second(request.value);
  response.success = true;
  return true;
}

void TaraSimulator::onImage(const sensor_msgs::ImageConstPtr& image) {
  const cv::Mat left = cv_bridge::toCvShare(image, sensor_msgs::image_encodings::MONO8)->image;
  if (left.cols != settings_.width || left.rows != settings_.height) {
    ROS_ERROR_THROTTLE(5.0, "An image of %dx%d is not what this camera sees.", left.cols, left.rows);
    return;
  }
  const std::uint64_t number = world_->picture_number + 1;
  TaraWorld::Picture& picture = world_->pictures[number % 2];
  for (int row = 0; row < left.rows; ++row) {
    const std::uint8_t* from = left.ptr(row);
    const int moved = std::min(settings_.disparity_px, left.cols - 1);
    const std::size_t begin = static_cast<std::size_t>(row) * static_cast<std::size_t>(left.cols);
    std::copy(from, from + left.cols, picture.left + begin);
    std::copy(from + moved, from + left.cols, picture.right + begin);
    std::fill_n(picture.right + begin + left.cols - moved, moved, from[left.cols - 1]);
  }
  world_->picture_number = number;
}

/// Views that differ and that a test can recompute from their first pixel: left = n + column, right = n -
/// row.
void TaraSimulator::showPattern() {
  const std::uint64_t number = world_->picture_number + 1;
  TaraWorld::Picture& picture = world_->pictures[number % 2];
  std::size_t pixel = 0;
  for (int row = 0; row < settings_.height; ++row) {
    for (int column = 0; column < settings_.width; ++column, ++pixel) {
      picture.left[pixel] = static_cast<std::uint8_t>((number + static_cast<std::uint64_t>(column)) % 128);
      picture.right[pixel] =
          static_cast<std::uint8_t>((number + 1000 - static_cast<std::uint64_t>(row)) % 128);
    }
  }
  world_->picture_number = number;
}

void TaraSimulator::publishState() {
  std_msgs::UInt32 message;
  message.data = world_->exposure;
  exposure_publisher_.publish(message);
  message.data = world_->brightness;
  brightness_publisher_.publish(message);
}

}  // namespace perennial
