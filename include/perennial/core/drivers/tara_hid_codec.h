#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

/// The HID reports of the TARA stereo camera (See3CAM_Stereo): bytes to structures and back. Requests have 65
/// bytes, of which the first is the report number 0; replies have 64. Integers have their high byte first.
/// Exposure, set-up and version go through the camera's control node, values of the inertial sensor through
/// its IMU node.
namespace perennial {

constexpr std::size_t kTaraRequestSize = 65;
constexpr std::size_t kTaraReplySize = 64;
constexpr int kTaraControlDescriptorSize = 29;  ///< size of the report descriptor of the control node
constexpr int kTaraImuDescriptorSize = 23;      ///< and of the IMU node

using TaraRequest = std::array<std::uint8_t, kTaraRequestSize>;
/// What was read, of whatever size: every decoder checks it, and gives nothing for a reply that is too short,
/// belongs to another request, or reports a failure.
using TaraReply = std::vector<std::uint8_t>;

constexpr std::uint32_t kTaraMinExposure = 10;
constexpr std::uint32_t kTaraMaxExposure = 1000000;
constexpr std::uint32_t kTaraDefaultExposure = 8000;
/// As an exposure: the camera chooses by itself.
constexpr std::uint32_t kTaraAutomaticExposure = 1;

struct TaraFirmware {
  int major = 0;
  int minor = 0;
  int sdk = 0;
  int svn = 0;
};

enum class TaraImuMode : std::uint8_t { kOff = 0, kAccelerometer = 1, kBoth = 3 };

/// Set-up of the inertial sensor (LSM6DS0), in the camera's codes.
struct TaraImuSetup {
  TaraImuMode mode = TaraImuMode::kBoth;
  std::uint8_t accelerometer_axes = 7;   ///< bits 1, 2, 4: x, y, z
  std::uint8_t rate = 3;                 ///< 1..6: see taraImuRate()
  std::uint8_t accelerometer_range = 0;  ///< see taraAccelerationUnit()
  std::uint8_t gyroscope_axes = 7;
  std::uint8_t gyroscope_range = 0;  ///< see taraAngularRateUnit()

  bool operator==(const TaraImuSetup& other) const {
    return mode == other.mode && accelerometer_axes == other.accelerometer_axes && rate == other.rate &&
           accelerometer_range == other.accelerometer_range && gyroscope_axes == other.gyroscope_axes &&
           gyroscope_range == other.gyroscope_range;
  }
};

/// Raw readings; the units depend on the ranges.
struct TaraImuReading {
  std::array<std::int16_t, 3> acceleration{};
  std::array<std::int16_t, 3> angular_rate{};
};

/// Hz for a rate code 1..6; 0 for another.
double taraImuRate(std::uint8_t code);
/// m/s^2 per bit for range codes 0, 2, 3, 1 (2, 4, 8, 16 g); 0 for another.
double taraAccelerationUnit(std::uint8_t range_code);
/// rad/s per bit for range codes 0, 1, 3 (245, 500, 2000 deg/s); 0 for another.
double taraAngularRateUnit(std::uint8_t range_code);

TaraRequest taraFirmwareRequest();
TaraRequest taraUniqueIdRequest();
TaraRequest taraGetExposureRequest();
/// `exposure`: brought into [kTaraMinExposure, kTaraMaxExposure] unless it is kTaraAutomaticExposure.
TaraRequest taraSetExposureRequest(std::uint32_t exposure);
TaraRequest taraGetImuSetupRequest();
TaraRequest taraSetImuSetupRequest(const TaraImuSetup& setup);
TaraRequest taraImuStreamRequest(bool on);
TaraRequest taraImuValuesRequest();
TaraRequest taraSetStreamModeRequest(std::uint8_t mode);
TaraRequest taraGetStreamModeRequest();

/// Whether this is the answer, good or bad, to the request.
bool answers(const TaraReply& reply, const TaraRequest& request);

std::optional<TaraFirmware> decodeTaraFirmware(const TaraReply& reply);
std::optional<std::uint32_t> decodeTaraUniqueId(const TaraReply& reply);
std::optional<std::uint32_t> decodeTaraExposure(const TaraReply& reply);
bool decodeTaraExposureSet(const TaraReply& reply);
std::optional<TaraImuSetup> decodeTaraImuSetup(const TaraReply& reply);
bool decodeTaraImuSetupSet(const TaraReply& reply);
bool decodeTaraImuStream(const TaraReply& reply);
std::optional<TaraImuReading> decodeTaraImuValues(const TaraReply& reply);
std::optional<std::uint8_t> decodeTaraStreamMode(const TaraReply& reply);
bool decodeTaraStreamModeSet(const TaraReply& reply);

}  // namespace perennial
