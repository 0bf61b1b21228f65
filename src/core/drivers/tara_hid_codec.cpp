#include "perennial/core/drivers/tara_hid_codec.h"

#include <algorithm>

namespace perennial {
namespace {

constexpr std::uint8_t kCamera = 0x78;
constexpr std::uint8_t kSuccess = 1;

// With the camera's prefix:
constexpr std::uint8_t kGetExposure = 0x01;
constexpr std::uint8_t kSetExposure = 0x02;
constexpr std::uint8_t kGetImuSetup = 0x03;
constexpr std::uint8_t kSetImuSetup = 0x04;
constexpr std::uint8_t kImuStream = 0x05;
constexpr std::uint8_t kImuValues = 0x06;
constexpr std::uint8_t kSetStreamMode = 0x0B;
constexpr std::uint8_t kGetStreamMode = 0x0C;
// Without it:
constexpr std::uint8_t kFirmware = 0x40;
constexpr std::uint8_t kUniqueId = 0x41;

constexpr std::uint8_t kImuStreamOn = 1;
constexpr std::uint8_t kImuStreamOff = 2;
constexpr std::uint8_t kAccelerationMark = 0xFE;
constexpr std::uint8_t kAngularRateMark = 0xFD;

constexpr double kStandardGravity = 9.80665;
constexpr double kRadiansPerDegree = 0.017453292519943295;

TaraRequest cameraRequest(std::uint8_t command) {
  TaraRequest request{};
  request[1] = kCamera;
  request[2] = command;
  return request;
}

bool isReplyTo(const TaraReply& reply, std::uint8_t command, std::size_t status_index) {
  return reply.size() > status_index && reply[0] == kCamera && reply[1] == command &&
         reply[status_index] == kSuccess;
}

std::uint32_t integer(const TaraReply& reply, std::size_t begin) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value = (value << 8) | reply[begin + i];
  }
  return value;
}

int shortInteger(const TaraReply& reply, std::size_t begin) { return (reply[begin] << 8) | reply[begin + 1]; }

std::array<std::int16_t, 3> vector(const TaraReply& reply, std::size_t begin) {
  std::array<std::int16_t, 3> values;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    values[axis] = static_cast<std::int16_t>(shortInteger(reply, begin + 2 * axis));
  }
  return values;
}

}  // namespace

double taraImuRate(std::uint8_t code) {
  constexpr std::array<double, 7> kRates = {0.0, 14.9, 59.5, 119.0, 238.0, 476.0, 952.0};
  return code < kRates.size() ? kRates[code] : 0.0;
}

double taraAccelerationUnit(std::uint8_t range_code) {
  constexpr std::array<double, 4> kMilliG = {0.061, 0.732, 0.122, 0.244};
  return range_code < kMilliG.size() ? kMilliG[range_code] * 1e-3 * kStandardGravity : 0.0;
}

double taraAngularRateUnit(std::uint8_t range_code) {
  constexpr std::array<double, 4> kDegrees = {0.00875, 0.0175, 0.0, 0.07};
  return range_code < kDegrees.size() ? kDegrees[range_code] * kRadiansPerDegree : 0.0;
}

TaraRequest taraFirmwareRequest() {
  TaraRequest request{};
  request[1] = kFirmware;
  return request;
}

TaraRequest taraUniqueIdRequest() {
  TaraRequest request{};
  request[1] = kUniqueId;
  return request;
}

TaraRequest taraGetExposureRequest() { return cameraRequest(kGetExposure); }

TaraRequest taraSetExposureRequest(std::uint32_t exposure) {
  const std::uint32_t value = exposure == kTaraAutomaticExposure
                                  ? exposure
                                  : std::clamp(exposure, kTaraMinExposure, kTaraMaxExposure);
  TaraRequest request = cameraRequest(kSetExposure);
  for (std::size_t i = 0; i < 4; ++i) {
    request[3 + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
  }
  return request;
}

TaraRequest taraGetImuSetupRequest() { return cameraRequest(kGetImuSetup); }

TaraRequest taraSetImuSetupRequest(const TaraImuSetup& setup) {
  TaraRequest request = cameraRequest(kSetImuSetup);
  request[3] = static_cast<std::uint8_t>(setup.mode);
  request[6] = setup.accelerometer_axes;
  request[7] = setup.rate;
  request[8] = setup.accelerometer_range;
  request[11] = setup.gyroscope_axes;
  request[13] = setup.gyroscope_range;
  return request;
}

TaraRequest taraImuStreamRequest(bool on) {
  TaraRequest request = cameraRequest(kImuStream);
  request[3] = on ? kImuStreamOn : kImuStreamOff;
  request[6] = 0xFF;
  return request;
}

TaraRequest taraImuValuesRequest() { return cameraRequest(kImuValues); }

TaraRequest taraSetStreamModeRequest(std::uint8_t mode) {
  TaraRequest request = cameraRequest(kSetStreamMode);
  request[3] = mode;
  return request;
}

TaraRequest taraGetStreamModeRequest() { return cameraRequest(kGetStreamMode); }

bool answers(const TaraReply& reply, const TaraRequest& request) {
  if (request[1] != kCamera) {
    return !reply.empty() && reply[0] == request[1];
  }
  return reply.size() > 1 && reply[0] == kCamera && reply[1] == request[2];
}

std::optional<TaraFirmware> decodeTaraFirmware(const TaraReply& reply) {
  if (reply.size() < 7 || reply[0] != kFirmware) {
    return std::nullopt;
  }
  return TaraFirmware{reply[1], reply[2], shortInteger(reply, 3), shortInteger(reply, 5)};
}

std::optional<std::uint32_t> decodeTaraUniqueId(const TaraReply& reply) {
  if (reply.size() < 5 || reply[0] != kUniqueId) {
    return std::nullopt;
  }
  return integer(reply, 1);
}

std::optional<std::uint32_t> decodeTaraExposure(const TaraReply& reply) {
  if (!isReplyTo(reply, kGetExposure, 10)) {
    return std::nullopt;
  }
  return integer(reply, 2);
}

bool decodeTaraExposureSet(const TaraReply& reply) { return isReplyTo(reply, kSetExposure, 10); }

std::optional<TaraImuSetup> decodeTaraImuSetup(const TaraReply& reply) {
  if (!isReplyTo(reply, kGetImuSetup, 25) || reply[2] == 2 || reply[2] > 3) {
    return std::nullopt;
  }
  return TaraImuSetup{static_cast<TaraImuMode>(reply[2]), reply[5], reply[6], reply[7], reply[10], reply[12]};
}

bool decodeTaraImuSetupSet(const TaraReply& reply) { return isReplyTo(reply, kSetImuSetup, 25); }

bool decodeTaraImuStream(const TaraReply& reply) { return isReplyTo(reply, kImuStream, 19); }

std::optional<TaraImuReading> decodeTaraImuValues(const TaraReply& reply) {
  if (!isReplyTo(reply, kImuValues, 48) || reply[4] != kAccelerationMark || reply[15] != kAngularRateMark) {
    return std::nullopt;
  }
  return TaraImuReading{vector(reply, 5), vector(reply, 16)};
}

std::optional<std::uint8_t> decodeTaraStreamMode(const TaraReply& reply) {
  if (!isReplyTo(reply, kGetStreamMode, 4)) {
    return std::nullopt;
  }
  return reply[2];
}

bool decodeTaraStreamModeSet(const TaraReply& reply) { return isReplyTo(reply, kSetStreamMode, 4); }

}  // namespace perennial
