#include "perennial/core/drivers/software_exposure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "perennial/core/drivers/tara_hid_codec.h"

namespace perennial {
namespace {

TEST(SoftwareExposure, looksAtEveryFifthImage) {
  SoftwareExposure control;
  for (int image = 1; image <= 20; ++image) {
    EXPECT_EQ(control.wantsImage(), image % 5 == 0);
  }
}

TEST(SoftwareExposure, followsTheLaw) {
  const SoftwareExposure control({128.0, 0.5, 5});
  EXPECT_EQ(control.next(64.0, 8000), 12000U);
  EXPECT_EQ(control.next(128.0, 8000), std::nullopt);
  EXPECT_EQ(control.next(256.0, 8000), 6000U);
}

TEST(SoftwareExposure, reachesTheTargetWithASaturatingCamera) {
  for (const double light : {0.0005, 0.005, 0.05, 1.0}) {
    const SoftwareExposure control;
    std::uint32_t exposure = 1000000;
    for (int step = 0; step < 30; ++step) {
      const double mean = std::min(255.0, light * exposure);
      exposure = control.next(mean, exposure).value_or(exposure);
    }
    EXPECT_NEAR(light * exposure, 128.0, 2.0) << light;
  }
}

TEST(SoftwareExposure, isGuarded) {
  const SoftwareExposure strong({255.0, 5.0, 1});
  EXPECT_EQ(strong.next(0.0, 8000), 16000U) << "a black image";
  EXPECT_EQ(strong.next(0.001, 8000), 64000U) << "no more than eightfold";
  EXPECT_EQ(strong.next(1.0, 900000), kTaraMaxExposure);
  EXPECT_EQ(strong.next(1.0, kTaraMaxExposure), std::nullopt);
  EXPECT_EQ(SoftwareExposure({0.0, 5.0, 1}).next(255.0, 20), kTaraMinExposure);
  EXPECT_EQ(strong.next(std::numeric_limits<double>::quiet_NaN(), 8000), std::nullopt);
}

}  // namespace
}  // namespace perennial
