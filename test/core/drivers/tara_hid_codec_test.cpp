#include "perennial/core/drivers/tara_hid_codec.h"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <random>

#include "perennial/core/drivers/tara_device.h"

namespace perennial {
namespace {

/// A request or reply of zeros but for these bytes.
template <typename Bytes>
Bytes with(Bytes bytes, const std::map<std::size_t, int>& set) {
  for (const auto& [index, value] : set) {
    bytes[index] = static_cast<std::uint8_t>(value);
  }
  return bytes;
}

TaraRequest request(const std::map<std::size_t, int>& set) { return with(TaraRequest{}, set); }
TaraReply reply(const std::map<std::size_t, int>& set) { return with(TaraReply(kTaraReplySize, 0), set); }

TEST(TaraHidCodec, writesRequestsToTheByte) {
  EXPECT_EQ(taraFirmwareRequest(), request({{1, 0x40}}));
  EXPECT_EQ(taraUniqueIdRequest(), request({{1, 0x41}}));
  EXPECT_EQ(taraGetExposureRequest(), request({{1, 0x78}, {2, 0x01}}));
  EXPECT_EQ(taraSetExposureRequest(0x00012345),
            request({{1, 0x78}, {2, 0x02}, {3, 0}, {4, 0x01}, {5, 0x23}, {6, 0x45}}));
  EXPECT_EQ(taraGetImuSetupRequest(), request({{1, 0x78}, {2, 0x03}}));
  EXPECT_EQ(taraSetImuSetupRequest({TaraImuMode::kBoth, 7, 4, 2, 5, 3}),
            request({{1, 0x78}, {2, 0x04}, {3, 3}, {6, 7}, {7, 4}, {8, 2}, {11, 5}, {13, 3}}));
  EXPECT_EQ(taraImuStreamRequest(true), request({{1, 0x78}, {2, 0x05}, {3, 1}, {6, 0xFF}}));
  EXPECT_EQ(taraImuStreamRequest(false), request({{1, 0x78}, {2, 0x05}, {3, 2}, {6, 0xFF}}));
  EXPECT_EQ(taraImuValuesRequest(), request({{1, 0x78}, {2, 0x06}}));
  EXPECT_EQ(taraSetStreamModeRequest(1), request({{1, 0x78}, {2, 0x0B}, {3, 1}}));
  EXPECT_EQ(taraGetStreamModeRequest(), request({{1, 0x78}, {2, 0x0C}}));
}

TEST(TaraHidCodec, keepsTheExposureInTheCamerasRange) {
  EXPECT_EQ(taraSetExposureRequest(0), taraSetExposureRequest(10));
  EXPECT_EQ(taraSetExposureRequest(4000000000U), taraSetExposureRequest(1000000));
  EXPECT_EQ(taraSetExposureRequest(kTaraAutomaticExposure)[6], 1);
}

TEST(TaraHidCodec, readsRepliesToTheByte) {
  const auto firmware =
      decodeTaraFirmware(reply({{0, 0x40}, {1, 1}, {2, 2}, {3, 1}, {4, 2}, {5, 3}, {6, 4}}));
  ASSERT_TRUE(firmware);
  EXPECT_EQ(firmware->major, 1);
  EXPECT_EQ(firmware->minor, 2);
  EXPECT_EQ(firmware->sdk, 0x0102);
  EXPECT_EQ(firmware->svn, 0x0304);
  EXPECT_EQ(decodeTaraUniqueId(reply({{0, 0x41}, {1, 0xDE}, {2, 0xAD}, {3, 0xBE}, {4, 0xEF}})), 0xDEADBEEFU);
  EXPECT_EQ(decodeTaraExposure(reply({{0, 0x78}, {1, 1}, {4, 0x1F}, {5, 0x40}, {10, 1}})), 8000U);
  EXPECT_TRUE(decodeTaraExposureSet(reply({{0, 0x78}, {1, 2}, {10, 1}})));
  EXPECT_EQ(decodeTaraImuSetup(
                reply({{0, 0x78}, {1, 3}, {2, 3}, {5, 7}, {6, 4}, {7, 2}, {10, 5}, {12, 3}, {25, 1}})),
            (TaraImuSetup{TaraImuMode::kBoth, 7, 4, 2, 5, 3}));
  EXPECT_TRUE(decodeTaraImuSetupSet(reply({{0, 0x78}, {1, 4}, {25, 1}})));
  EXPECT_TRUE(decodeTaraImuStream(reply({{0, 0x78}, {1, 5}, {19, 1}})));
  EXPECT_EQ(decodeTaraStreamMode(reply({{0, 0x78}, {1, 0x0C}, {2, 1}, {4, 1}})), std::uint8_t{1});
  EXPECT_TRUE(decodeTaraStreamModeSet(reply({{0, 0x78}, {1, 0x0B}, {4, 1}})));
}

TEST(TaraHidCodec, readsImuValues) {
  const auto values = decodeTaraImuValues(reply({{0, 0x78},
                                                 {1, 6},
                                                 {4, 0xFE},
                                                 {5, 0x01},
                                                 {6, 0x02},
                                                 {7, 0xFF},
                                                 {8, 0xFE},
                                                 {9, 0x7F},
                                                 {10, 0xFF},
                                                 {15, 0xFD},
                                                 {16, 0x80},
                                                 {17, 0x00},
                                                 {18, 0},
                                                 {19, 5},
                                                 {20, 0xFF},
                                                 {21, 0xFF},
                                                 {48, 1}}));
  ASSERT_TRUE(values);
  EXPECT_EQ(values->acceleration, (std::array<std::int16_t, 3>{0x0102, -2, 32767}));
  EXPECT_EQ(values->angular_rate, (std::array<std::int16_t, 3>{-32768, 5, -1}));
}

TEST(TaraHidCodec, knowsUnits) {
  EXPECT_DOUBLE_EQ(taraImuRate(1), 14.9);
  EXPECT_DOUBLE_EQ(taraImuRate(6), 952.0);
  EXPECT_EQ(taraImuRate(0), 0.0);
  EXPECT_EQ(taraImuRate(7), 0.0);
  EXPECT_NEAR(taraAccelerationUnit(0) * 32768 / 9.80665, 2.0, 0.01);
  EXPECT_NEAR(taraAccelerationUnit(2) * 32768 / 9.80665, 4.0, 0.01);
  EXPECT_NEAR(taraAccelerationUnit(3) * 32768 / 9.80665, 8.0, 0.01);
  EXPECT_NEAR(taraAccelerationUnit(1), 0.732e-3 * 9.80665, 1e-12);
  EXPECT_NEAR(taraAngularRateUnit(0), 0.00875 * 3.14159265 / 180.0, 1e-9);
  EXPECT_NEAR(taraAngularRateUnit(3), 0.07 * 3.14159265 / 180.0, 1e-9);
  EXPECT_EQ(taraAngularRateUnit(2), 0.0);
  EXPECT_EQ(taraAccelerationUnit(4), 0.0);
}

TEST(TaraHidCodec, refusesFailuresStrangersAndShortReplies) {
  const TaraReply good = reply({{0, 0x78}, {1, 1}, {4, 0x1F}, {5, 0x40}, {10, 1}});
  for (const auto& [index, value] : std::map<std::size_t, int>{{0, 0x79}, {1, 2}, {10, 0}}) {
    EXPECT_FALSE(decodeTaraExposure(with(good, {{index, value}}))) << "byte " << index;
  }
  for (std::size_t size = 0; size <= 10; ++size) {
    EXPECT_FALSE(
        decodeTaraExposure(TaraReply(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size))));
  }
  EXPECT_FALSE(decodeTaraImuSetup(reply({{0, 0x78}, {1, 3}, {2, 2}, {25, 1}}))) << "there is no mode 2";
  EXPECT_FALSE(decodeTaraImuValues(reply({{0, 0x78}, {1, 6}, {4, 0xFE}, {48, 1}}))) << "half a report";
}

TEST(TaraHidCodec, survivesNoise) {
  std::mt19937 random(4);
  for (int round = 0; round < 20000; ++round) {
    TaraReply noise(random() % 70);
    for (std::uint8_t& byte : noise) {
      byte = static_cast<std::uint8_t>(random());
    }
    // Random bytes are as good as never a whole reply, but must never be read beyond their end.
    EXPECT_FALSE(decodeTaraExposure(noise) && decodeTaraImuSetup(noise));
    EXPECT_FALSE(decodeTaraImuValues(noise));
    decodeTaraFirmware(noise);
    decodeTaraUniqueId(noise);
    answers(noise, taraGetExposureRequest());
  }
}

TEST(TaraDevice, answersWhatTheCodecAsks) {
  TaraDevice device;
  EXPECT_EQ(decodeTaraExposure(device.answer(taraGetExposureRequest())), kTaraDefaultExposure);
  EXPECT_TRUE(decodeTaraExposureSet(device.answer(taraSetExposureRequest(12345))));
  EXPECT_EQ(decodeTaraExposure(device.answer(taraGetExposureRequest())), 12345U);
  const TaraImuSetup setup{TaraImuMode::kBoth, 7, 4, 2, 7, 3};
  EXPECT_FALSE(device.imuStreams());
  EXPECT_TRUE(decodeTaraImuSetupSet(device.answer(taraSetImuSetupRequest(setup))));
  EXPECT_EQ(decodeTaraImuSetup(device.answer(taraGetImuSetupRequest())), setup);
  EXPECT_TRUE(decodeTaraImuStream(device.answer(taraImuStreamRequest(true))));
  EXPECT_TRUE(device.imuStreams());
  const auto values = decodeTaraImuValues(device.answer(taraImuValuesRequest()));
  ASSERT_TRUE(values);
  EXPECT_NEAR(values->acceleration[2] * taraAccelerationUnit(2), 9.80665, 0.001);
  EXPECT_TRUE(decodeTaraFirmware(device.answer(taraFirmwareRequest())));
  EXPECT_EQ(decodeTaraUniqueId(device.answer(taraUniqueIdRequest())), 0x2560C114U);
  EXPECT_TRUE(decodeTaraStreamModeSet(device.answer(taraSetStreamModeRequest(1))));
  EXPECT_EQ(decodeTaraStreamMode(device.answer(taraGetStreamModeRequest())), std::uint8_t{1});
  EXPECT_TRUE(device.answer(request({{1, 0x78}, {2, 0x33}})).empty());
}

TEST(TaraHidCodec, matchesRepliesWithRequests) {
  TaraDevice device;
  for (const TaraRequest& sent :
       {taraFirmwareRequest(), taraUniqueIdRequest(), taraGetExposureRequest(), taraSetExposureRequest(50),
        taraImuStreamRequest(true), taraGetStreamModeRequest()}) {
    EXPECT_TRUE(answers(device.answer(sent), sent));
    EXPECT_FALSE(answers(device.answer(taraImuValuesRequest()), sent));
    EXPECT_FALSE(answers({}, sent));
  }
}

}  // namespace
}  // namespace perennial
