// When a sender is taken for one that was started anew.
#include <gtest/gtest.h>

#include "perennial/core/restart_watch.h"

namespace perennial {
namespace {

TEST(RestartWatch, isContentWithNumbersThatGoOn) {
  RestartWatch watch;
  for (const std::uint32_t number : {7U, 8U, 9U, 25U, 1000U}) {
    EXPECT_FALSE(watch.restarted(number)) << number;
  }
}

TEST(RestartWatch, noticesNumbersThatBeginAnewOnce) {
  RestartWatch watch;
  watch.restarted(500);
  EXPECT_TRUE(watch.restarted(1));
  EXPECT_FALSE(watch.restarted(2));
}

TEST(RestartWatch, letsNumbersWrap) {
  RestartWatch watch;
  watch.restarted(0xFFFFFFFEU);
  EXPECT_FALSE(watch.restarted(0xFFFFFFFFU));
  EXPECT_FALSE(watch.restarted(0));
}

TEST(RestartWatch, doesNotMindSendersThatDoNotCount) {
  RestartWatch watch;
  for (int i = 0; i < 5; ++i) {
    EXPECT_FALSE(watch.restarted(0));
  }
}

TEST(RestartWatch, forgets) {
  RestartWatch watch;
  watch.restarted(500);
  watch.reset();
  EXPECT_FALSE(watch.restarted(1));
}

}  // namespace
}  // namespace perennial
