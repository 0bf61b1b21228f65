#include "perennial/core/drivers/tara_device.h"

#include <cmath>

namespace perennial {
namespace {

constexpr std::uint32_t kUniqueId = 0x2560C114;
constexpr double kStandardGravity = 9.80665;

void put(std::uint32_t value, std::size_t begin, TaraReply& reply) {
  for (std::size_t i = 0; i < 4; ++i) {
    reply[begin + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
  }
}

void putVector(const std::array<std::int16_t, 3>& values, std::size_t begin, TaraReply& reply) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto bits = static_cast<std::uint16_t>(values[axis]);
    reply[begin + 2 * axis] = static_cast<std::uint8_t>(bits >> 8);
    reply[begin + 2 * axis + 1] = static_cast<std::uint8_t>(bits & 0xFF);
  }
}

}  // namespace

TaraReply TaraDevice::answer(const TaraRequest& request) {
  TaraReply reply(kTaraReplySize, 0);
  if (request[1] == 0x40) {
    reply[0] = 0x40;
    reply[1] = 1;
    reply[2] = 2;
    reply[4] = 114;
    reply[6] = 77;
    return reply;
  }
  if (request[1] == 0x41) {
    reply[0] = 0x41;
    put(kUniqueId, 1, reply);
    return reply;
  }
  reply[0] = request[1];
  reply[1] = request[2];
  switch (request[2]) {
    case 0x01:
      put(exposure_, 2, reply);
      reply[10] = 1;
      return reply;
    case 0x02:
      exposure_ = static_cast<std::uint32_t>(request[3]) << 24 |
                  static_cast<std::uint32_t>(request[4]) << 16 | static_cast<std::uint32_t>(request[5]) << 8 |
                  request[6];
      reply[10] = 1;
      return reply;
    case 0x03:
      reply[2] = static_cast<std::uint8_t>(imu_.mode);
      reply[5] = imu_.accelerometer_axes;
      reply[6] = imu_.rate;
      reply[7] = imu_.accelerometer_range;
      reply[10] = imu_.gyroscope_axes;
      reply[12] = imu_.gyroscope_range;
      reply[25] = 1;
      return reply;
    case 0x04:
      imu_ = {
          static_cast<TaraImuMode>(request[3]), request[6], request[7], request[8], request[11], request[13]};
      reply[25] = 1;
      return reply;
    case 0x05:
      imu_streams_ = request[3] == 1;
      reply[19] = 1;
      return reply;
    case 0x06:
      return imuReport(imuReading());
    case 0x0B:
      stream_mode_ = request[3];
      reply[4] = 1;
      return reply;
    case 0x0C:
      reply[2] = stream_mode_;
      reply[4] = 1;
      return reply;
    default:
      return {};
  }
}

TaraReply TaraDevice::imuReport(const TaraImuReading& reading) {
  TaraReply reply(kTaraReplySize, 0);
  reply[0] = 0x78;
  reply[1] = 0x06;
  reply[4] = 0xFE;
  putVector(reading.acceleration, 5, reply);
  reply[15] = 0xFD;
  putVector(reading.angular_rate, 16, reply);
  reply[48] = 1;
  return reply;
}

TaraImuReading TaraDevice::imuReading() const {
  const double unit = taraAccelerationUnit(imu_.accelerometer_range);
  TaraImuReading reading;
  if (unit > 0.0) {
    reading.acceleration[2] = static_cast<std::int16_t>(std::lround(kStandardGravity / unit));
  }
  return reading;
}

}  // namespace perennial
