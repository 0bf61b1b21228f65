#include "perennial/core/utc_time.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "perennial/core/error.h"

namespace perennial {
namespace {

TEST(UtcTime, readsKnownTimes) {
  EXPECT_EQ(parseUtc("1970-01-01T00:00:00Z"), 0.0);
  EXPECT_EQ(parseUtc("2000-03-01T00:00:00Z"), 951868800.0) << "2000 was a leap year";
  EXPECT_EQ(parseUtc("2014-09-27T05:27:00Z"), 1411795620.0);
  EXPECT_EQ(parseUtc("2014-09-27T05:27:00.25Z"), 1411795620.25);
  EXPECT_EQ(parseUtc("2014-09-27T07:27:00+02:00"), 1411795620.0);
  EXPECT_EQ(parseUtc("2014-09-27T00:57:00-04:30"), 1411795620.0);
  EXPECT_EQ(parseUtc("1969-12-31T23:59:59Z"), -1.0);
}

TEST(UtcTime, refusesAnythingElse) {
  for (const char* text :
       {"", "2014-09-27", "2014-09-27T05:27:00", "2014-09-27 05:27:00Z", "2014-13-01T00:00:00Z",
        "2014-00-01T00:00:00Z", "2014-02-29T00:00:00Z", "1900-02-29T00:00:00Z", "2014-02-01T24:00:00Z",
        "2014-02-01T00:60:00Z", "2014-02-01T00:00:60Z", "2014-02-01T00:00:00Zx", " 2014-02-01T00:00:00Z",
        "1411795620"}) {
    EXPECT_FALSE(parseUtc(text)) << text;
  }
}

TEST(UtcTime, writesWhatItReads) {
  EXPECT_EQ(formatUtc(1411795620.0), "2014-09-27T05:27:00Z");
  EXPECT_EQ(formatUtc(1411795620.25), "2014-09-27T05:27:00.250000Z");
  EXPECT_EQ(formatUtc(-1.0), "1969-12-31T23:59:59Z");
  EXPECT_EQ(formatUtc(1411795619.9999999), "2014-09-27T05:27:00Z") << "rounded to the microsecond";
  std::mt19937 random(1);
  std::uniform_int_distribution<std::int64_t> seconds(-62167219200, 253402300000);  // years 0 to 9999
  for (int i = 0; i < 1000; ++i) {
    const auto stamp = static_cast<double>(seconds(random));
    EXPECT_EQ(parseUtc(formatUtc(stamp)), stamp) << formatUtc(stamp);
  }
}

TEST(UtcTime, refusesToWriteWhatHasNoDate) {
  EXPECT_THROW(formatUtc(1e30), Error);
  EXPECT_THROW(formatUtc(-1e12), Error);
  EXPECT_THROW(formatUtc(std::numeric_limits<double>::quiet_NaN()), Error);
}

}  // namespace
}  // namespace perennial
