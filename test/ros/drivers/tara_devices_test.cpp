#include "perennial/ros/drivers/tara_devices.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "perennial/testing/temporary_folder.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

/// A /sys as the kernel shows it, with what the driver looks at.
class TaraDevicesTest : public ::testing::Test {
 protected:
  static void write(const fs::path& file, const std::string& text) {
    fs::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }

  fs::path sysfs() const { return fs::path(folder_.path()) / "sys"; }

  fs::path plugIn(const std::string& port, const std::string& vendor, const std::string& product,
                  const std::string& serial) const {
    const fs::path usb = sysfs() / "devices" / "usb1" / port;
    write(usb / "idVendor", vendor + "\n");
    write(usb / "idProduct", product + "\n");
    if (!serial.empty()) {
      write(usb / "serial", serial + "\n");
    }
    return usb;
  }

  void addVideo(const fs::path& usb, const std::string& name, int index) const {
    fs::create_directories(usb / "1.0");
    write(sysfs() / "class" / "video4linux" / name / "index", std::to_string(index) + "\n");
    fs::create_directory_symlink(usb / "1.0", sysfs() / "class" / "video4linux" / name / "device");
  }

  void addHid(const fs::path& usb, const std::string& name, std::size_t descriptor_size) const {
    const fs::path device = usb / ("1.2-" + name);
    write(device / "report_descriptor", std::string(descriptor_size, '\0'));
    fs::create_directories(sysfs() / "class" / "hidraw" / name);
    fs::create_directory_symlink(device, sysfs() / "class" / "hidraw" / name / "device");
  }

  test_tools::TemporaryFolder folder_;
};

TEST_F(TaraDevicesTest, tellsTwoCamerasAndTheirNodesApart) {
  const fs::path second = plugIn("1-2", "2560", "c114", "B");
  const fs::path first = plugIn("1-1", "2560", "c114", "A");
  addVideo(first, "video0", 0);
  addVideo(first, "video1", 1);
  addVideo(second, "video2", 0);
  addHid(second, "hidraw0", 23);
  addHid(second, "hidraw1", 29);
  addHid(first, "hidraw2", 29);
  addHid(first, "hidraw3", 23);
  const auto cameras = findTaraDevices(sysfs(), "/dev");
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[0].video, "/dev/video0");
  EXPECT_EQ(cameras[0].serial, "A");
  EXPECT_EQ(cameras[0].control, "/dev/hidraw2");
  EXPECT_EQ(cameras[0].imu, "/dev/hidraw3");
  EXPECT_EQ(cameras[1].video, "/dev/video2");
  EXPECT_EQ(cameras[1].serial, "B");
  EXPECT_EQ(cameras[1].control, "/dev/hidraw1");
  EXPECT_EQ(cameras[1].imu, "/dev/hidraw0");
}

TEST_F(TaraDevicesTest, leavesOtherDevicesAlone) {
  addVideo(plugIn("1-1", "2560", "c113", "X"), "video0", 0);
  addVideo(plugIn("1-2", "046d", "c114", "Y"), "video1", 0);
  addHid(plugIn("1-3", "2560", "c114", "Z"), "hidraw0", 29);
  EXPECT_TRUE(findTaraDevices(sysfs(), "/dev").empty());
}

TEST_F(TaraDevicesTest, aCameraWithoutSerialAndHidNodesIsStillOne) {
  const fs::path usb = plugIn("1-1", "2560", "c114", "");
  addVideo(usb, "video3", 0);
  addHid(usb, "hidraw0", 77);  // neither of the two
  const auto cameras = findTaraDevices(sysfs(), "/dev");
  ASSERT_EQ(cameras.size(), 1U);
  EXPECT_EQ(cameras[0].video, "/dev/video3");
  EXPECT_EQ(cameras[0].serial, "");
  EXPECT_EQ(cameras[0].control, "");
  EXPECT_EQ(cameras[0].imu, "");
}

TEST_F(TaraDevicesTest, noSysfsMeansNoCamera) {
  EXPECT_TRUE(findTaraDevices("/no/such/folder", "/dev").empty());
}

}  // namespace
}  // namespace perennial
