#include "core/features/duplicate_filter.h"

#include <gtest/gtest.h>

namespace perennial {
namespace {

Candidate candidate(float x, float y, float scale, int octave) { return {{x, y, scale, 1.0F}, octave}; }

class Duplicates : public ::testing::Test {
 protected:
  void SetUp() override { filter_.reset(640, 480, 4); }

  DuplicateFilter filter_;
};

TEST_F(Duplicates, sameBlobOfAnotherOctaveIsRefused) {
  EXPECT_TRUE(filter_.accept(candidate(100.0F, 100.0F, 3.6F, 0)));
  EXPECT_FALSE(filter_.accept(candidate(101.0F, 101.0F, 4.0F, 1)));
  EXPECT_FALSE(filter_.accept(candidate(106.0F, 95.0F, 4.8F, 3))) << "within 8 px, the step of octave 3";
}

TEST_F(Duplicates, distanceIsMeasuredInTheCoarserStep) {
  EXPECT_TRUE(filter_.accept(candidate(100.0F, 100.0F, 3.6F, 1)));
  EXPECT_FALSE(filter_.accept(candidate(102.0F, 100.0F, 3.6F, 0)));
  EXPECT_TRUE(filter_.accept(candidate(102.1F, 100.0F, 3.6F, 0)));
  EXPECT_FALSE(filter_.accept(candidate(104.0F, 100.0F, 3.6F, 2)));
}

TEST_F(Duplicates, otherScalesAreOtherBlobs) {
  EXPECT_TRUE(filter_.accept(candidate(100.0F, 100.0F, 3.0F, 0)));
  EXPECT_TRUE(filter_.accept(candidate(100.0F, 100.0F, 4.3F, 1)));
  EXPECT_TRUE(filter_.accept(candidate(100.0F, 100.0F, 2.1F, 1)));
}

TEST_F(Duplicates, oneOctaveHasNone) {
  EXPECT_TRUE(filter_.accept(candidate(100.0F, 100.0F, 3.0F, 1)));
  EXPECT_TRUE(filter_.accept(candidate(100.0F, 100.0F, 3.0F, 1)));
}

TEST_F(Duplicates, neighboursAreFoundAcrossCells) {
  EXPECT_TRUE(filter_.accept(candidate(15.9F, 15.9F, 3.0F, 2)));
  EXPECT_FALSE(filter_.accept(candidate(16.1F, 16.1F, 3.0F, 1)));
  EXPECT_FALSE(filter_.accept(candidate(16.1F, 15.8F, 3.0F, 1)));
  EXPECT_TRUE(filter_.accept(candidate(639.0F, 479.0F, 3.0F, 2))) << "the last cell";
  EXPECT_FALSE(filter_.accept(candidate(637.0F, 478.0F, 3.0F, 1)));
}

TEST_F(Duplicates, onlyWhatWasAcceptedCounts) {
  EXPECT_TRUE(filter_.accept(candidate(100.0F, 100.0F, 3.0F, 0)));
  EXPECT_FALSE(filter_.accept(candidate(102.0F, 100.0F, 3.0F, 1)));
  EXPECT_TRUE(filter_.accept(candidate(104.0F, 100.0F, 3.0F, 0)))
      << "near the refused one, not the accepted one";
}

TEST_F(Duplicates, resetForgets) {
  EXPECT_TRUE(filter_.accept(candidate(100.0F, 100.0F, 3.0F, 0)));
  filter_.reset(320, 240, 6);
  EXPECT_TRUE(filter_.accept(candidate(100.0F, 100.0F, 3.0F, 1)));
}

}  // namespace
}  // namespace perennial
