#pragma once

#include <optional>
#include <string>
#include <vector>

namespace perennial {

/// The device files of one TARA camera.
struct TaraDevices {
  std::string video;    ///< the V4L2 node that streams
  std::string control;  ///< hidraw node for requests; empty when there is none
  std::string imu;      ///< hidraw node of the inertial sensor; empty when there is none
  std::string serial;   ///< serial number of the USB device; may be empty
};

/// All cameras (USB 2560:c114) that `sysfs_root` (/sys) knows, sorted by video node, their device files below
/// `dev_root`
/// (/dev). The two hidraw nodes are told apart by the size of their report descriptors.
std::vector<TaraDevices> findTaraDevices(const std::string& sysfs_root, const std::string& dev_root);

}  // namespace perennial
