#include "perennial/ros/drivers/tara_devices.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "perennial/core/drivers/tara_hid_codec.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVendor = "2560";
constexpr const char* kProduct = "c114";

std::string firstLine(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

std::size_t sizeOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return static_cast<std::size_t>(
      std::distance(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()));
}

/// The USB device that a class device belongs to: the nearest folder above with a vendor.
fs::path usbDeviceOf(const fs::path& class_device) {
  std::error_code error;
  fs::path folder = fs::canonical(class_device / "device", error);
  while (!error && folder.has_relative_path()) {
    if (fs::exists(folder / "idVendor", error)) {
      return folder;
    }
    folder = folder.parent_path();
  }
  return {};
}

bool isTara(const fs::path& usb_device) {
  return !usb_device.empty() && firstLine(usb_device / "idVendor") == kVendor &&
         firstLine(usb_device / "idProduct") == kProduct;
}

std::vector<fs::path> entries(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> found;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    found.push_back(entry->path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

void addHidNodes(const fs::path& sysfs, const fs::path& dev, const fs::path& usb_device,
                 TaraDevices& devices) {
  for (const fs::path& hidraw : entries(sysfs / "class" / "hidraw")) {
    if (usbDeviceOf(hidraw) != usb_device) {
      continue;
    }
    const std::size_t descriptor_size = sizeOf(hidraw / "device" / "report_descriptor");
    if (descriptor_size == kTaraControlDescriptorSize) {
      devices.control = dev / hidraw.filename();
    } else if (descriptor_size == kTaraImuDescriptorSize) {
      devices.imu = dev / hidraw.filename();
    }
  }
}

}  // namespace

std::vector<TaraDevices> findTaraDevices(const std::string& sysfs_root, const std::string& dev_root) {
  const fs::path sysfs(sysfs_root);
  const fs::path dev(dev_root);
  std::vector<TaraDevices> cameras;
  for (const fs::path& video : entries(sysfs / "class" / "video4linux")) {
    const fs::path usb_device = usbDeviceOf(video);
    // A camera's second node, index 1, holds metadata.
    if (!isTara(usb_device) || firstLine(video / "index") != "0") {
      continue;
    }
    TaraDevices devices;
    devices.video = dev / video.filename();
    devices.serial = firstLine(usb_device / "serial");
    addHidNodes(sysfs, dev, usb_device, devices);
    cameras.push_back(devices);
  }
  return cameras;
}

}  // namespace perennial
