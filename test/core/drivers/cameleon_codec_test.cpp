#include "perennial/core/drivers/cameleon_codec.h"

#include <gtest/gtest.h>

#include <limits>

namespace perennial {
namespace {

TEST(CameleonCodec, writesTheHandshake) {
  EXPECT_EQ(encode(CameleonHandshake{true, false, true, false}), (CameleonHandshakeBytes{1, 0, 1, 0}));
  const auto decoded = decodeHandshake({0, 1, 1, 1});
  ASSERT_TRUE(decoded);
  EXPECT_FALSE(decoded->drive);
  EXPECT_TRUE(decoded->buttons);
  EXPECT_FALSE(decodeHandshake({1, 1, 2, 0}));
}

TEST(CameleonCodec, writesACommandToTheByte) {
  const CameleonCommand command{CameleonCommandType::kSpeed, 500, -300, -47};
  EXPECT_EQ(encode(command), (CameleonCommandBytes{2, 0xF4, 0x01, 0, 0x2C, 0x01, 1, 47, 0, 1}));
  EXPECT_EQ(encode(CameleonCommand{CameleonCommandType::kStop, 0, 0, 0}), (CameleonCommandBytes{5}));
}

TEST(CameleonCodec, neverSendsWhatTheRobotWouldCut) {
  const CameleonCommand command{CameleonCommandType::kSpeed, 10000, -1000, 48};
  const auto decoded = decodeCommand(encode(command));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(*decoded, (CameleonCommand{CameleonCommandType::kSpeed, 9999, -999, 47}));
}

TEST(CameleonCodec, readsBackEveryCommand) {
  for (int type = 0; type <= 7; ++type) {
    for (int forward = -9999; forward <= 9999; forward += 37) {
      const CameleonCommand command{static_cast<CameleonCommandType>(type), forward, forward / 11,
                                    forward / 300};
      const auto decoded = decodeCommand(encode(command));
      ASSERT_TRUE(decoded);
      ASSERT_EQ(*decoded, command);
    }
  }
}

TEST(CameleonCodec, refusesCommandsThatAreNone) {
  EXPECT_FALSE(decodeCommand({8}));
  for (std::size_t sign : {3, 6, 9}) {
    CameleonCommandBytes bytes{2};
    bytes[sign] = 2;
    EXPECT_FALSE(decodeCommand(bytes)) << "sign byte " << sign;
  }
}

TEST(CameleonCodec, convertsVelocities) {
  const CameleonScale scale;
  EXPECT_EQ(toSpeedCommand({0.25, -0.3, 0.02}, scale),
            (CameleonCommand{CameleonCommandType::kSpeed, 250, -300, 20}));
  EXPECT_EQ(toSpeedCommand({100.0, -100.0, 1.0}, scale),
            (CameleonCommand{CameleonCommandType::kSpeed, 9999, -999, 47}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(toSpeedCommand({nan, infinity, -infinity}, scale),
            (CameleonCommand{CameleonCommandType::kSpeed, 0, 0, 0}));
  EXPECT_EQ(toVelocity({CameleonCommandType::kSpeed, -500, 100, 0}, {1000.0, 500.0, 1.0}),
            (Velocity{-0.5, 0.2, 0.0}));
}

TEST(CameleonCodec, writesAStatusToTheByte) {
  const CameleonStatus status{true, 0x01020304, -2, 10, -10, 45, 87};
  const CameleonStatusBytes expected{0xF0, 0xAF, 0xFA, 7,    0,    0,  0, 1, 1,  2,    3,
                                     4,    0xFF, 0xFF, 0xFF, 0xFE, 0,  0, 0, 10, 0xFF, 0xFF,
                                     0xFF, 0xF6, 0,    0,    0,    45, 0, 0, 0,  87};
  EXPECT_EQ(encode(status), expected);
}

}  // namespace
}  // namespace perennial
