#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "core/registration/neighbour_list.h"
#include "core/registration/vote_profile.h"

namespace perennial {
namespace {

TEST(NeighbourList, holdsTheNearestInOrder) {
  std::mt19937 random(1);
  for (int round = 0; round < 200; ++round) {
    NeighbourList list;
    std::vector<std::pair<std::uint16_t, std::uint32_t>> all;
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(round % 12); ++i) {
      const std::uint32_t index = (i * 7 + static_cast<std::uint32_t>(round)) % 101;  // not in order
      const auto distance = static_cast<std::uint16_t>(random() % 6);                 // many equal ones
      all.emplace_back(distance, index);
      list.offer(distance, index);
    }
    std::sort(all.begin(), all.end());
    ASSERT_EQ(list.size(), std::min(all.size(), NeighbourList::kCapacity));
    for (std::size_t rank = 0; rank < list.size(); ++rank) {
      EXPECT_EQ(list[rank].distance, all[rank].first);
      EXPECT_EQ(list[rank].index, all[rank].second);
      EXPECT_EQ(list.rankOf(all[rank].second), rank);
    }
    EXPECT_EQ(list.rankOf(1000), NeighbourList::kCapacity);
  }
}

TEST(VoteProfile, peakOfOneVoteIsThere) {
  for (const double place : {-333.3, 0.0, 1.25, 500.0}) {
    const VotePeak peak = VoteProfile().findPeak({{place, 2.0}});
    EXPECT_NEAR(peak.displacement_px, place, 1e-6);
    EXPECT_NEAR(peak.width_px, 0.0, 1e-6);
    EXPECT_NEAR(peak.height, 2.0, 0.05);
    EXPECT_NEAR(peak.second_height, 0.0, 0.02);
  }
}

TEST(VoteProfile, manyScatteredVotesBeatAStrongOne) {
  std::vector<Vote> votes{{-200.0, 2.0}};
  for (int k = -5; k <= 5; ++k) {
    votes.push_back({80.0 + 2.0 * k, 0.5});
  }
  const VotePeak peak = VoteProfile().findPeak(votes);
  EXPECT_NEAR(peak.displacement_px, 80.0, 1e-6);
  EXPECT_NEAR(peak.second_height, 2.0, 0.1);
  EXPECT_NEAR(peak.width_px, 2.0 * std::sqrt(10.0), 0.1);
}

TEST(VoteProfile, ofEqualPeaksTheOneNearerToZeroThenThePositive) {
  EXPECT_NEAR(VoteProfile().findPeak({{-200.0, 1.0}, {100.0, 1.0}}).displacement_px, 100.0, 0.1);
  EXPECT_NEAR(VoteProfile().findPeak({{-100.0, 1.0}, {200.0, 1.0}}).displacement_px, -100.0, 0.1);
  EXPECT_NEAR(VoteProfile().findPeak({{-100.0, 1.0}, {100.0, 1.0}}).displacement_px, 100.0, 0.1);
}

}  // namespace
}  // namespace perennial
