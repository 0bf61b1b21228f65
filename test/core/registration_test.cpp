#include "perennial/core/registration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "perennial/core/error.h"

namespace perennial {
namespace {

Descriptor randomDescriptor(std::mt19937& random) {
  std::uniform_int_distribution<std::uint64_t> bits;
  Descriptor descriptor;
  for (auto& word : descriptor.words) {
    word = bits(random);
  }
  return descriptor;
}

FeatureSet randomFeatures(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> x(30.0F, 720.0F);
  std::uniform_real_distribution<float> y(30.0F, 450.0F);
  FeatureSet features;
  for (std::size_t i = 0; i < n; ++i) {
    features.add({x(random), y(random), 2.0F, 0.1F}, randomDescriptor(random));
  }
  return features;
}

/// The scene as seen when it lies `dx` px further right and `dy` further down.
FeatureSet moved(FeatureSet features, float dx, float dy = 0.0F) {
  for (Keypoint& keypoint : features.keypoints) {
    keypoint.x += dx;
    keypoint.y += dy;
  }
  return features;
}

TEST(Registration, findsTheDisplacementAndItsSign) {
  const FeatureSet map = randomFeatures(200, 1);
  // A camera turned left sees the scene further right: x_map - x_view is negative.
  const RegistrationResult result = HistogramRegistration().registerView(map, moved(map, 37.5F, 3.0F));
  ASSERT_TRUE(result.displacement_px);
  EXPECT_NEAR(*result.displacement_px, -37.5, 1e-3);
  EXPECT_EQ(result.inliers, 200);
  EXPECT_EQ(result.matches, 200);
  for (std::size_t i = 0; i < map.size(); ++i) {
    EXPECT_EQ(result.partners[i], static_cast<int>(i));
    EXPECT_EQ(result.states[i], FeatureState::kMatchedCorrectly);
  }
}

TEST(Registration, isAntisymmetric) {
  // Every displacement, around the borders of the bins above all, gives the mirrored result when mirrored.
  const FeatureSet map = randomFeatures(50, 2);
  for (float dx = -70.0F; dx <= 70.0F; dx += 2.5F) {
    const RegistrationResult right = HistogramRegistration().registerView(map, moved(map, dx));
    const RegistrationResult left = HistogramRegistration().registerView(moved(map, dx), map);
    ASSERT_TRUE(right.displacement_px && left.displacement_px);
    EXPECT_NEAR(*right.displacement_px, -*left.displacement_px, 1e-9);
    EXPECT_EQ(right.histogram.counts,
              std::vector<int>(left.histogram.counts.rbegin(), left.histogram.counts.rend()));
  }
}

TEST(Registration, binsAroundZeroAreSymmetric) {
  // 15 differences of -9 and 15 of +9 px share the bin of 0; truncating division would do so for +-19 as
  // well.
  FeatureSet map = randomFeatures(30, 3);
  FeatureSet view = map;
  for (std::size_t i = 0; i < 30; ++i) {
    view.keypoints[i].x += i % 2 == 0 ? 9.0F : -9.0F;
  }
  const auto near = HistogramRegistration().registerView(map, view);
  EXPECT_EQ(near.histogram.counts, std::vector<int>{30});
  for (std::size_t i = 0; i < 30; ++i) {
    view.keypoints[i].x = map.keypoints[i].x + (i % 2 == 0 ? 19.0F : -19.0F);
  }
  const auto far = HistogramRegistration().registerView(map, view);
  EXPECT_EQ(far.histogram.counts, (std::vector<int>{15, 0, 15}));
}

TEST(Registration, averagesWithinOneAndAHalfBins) {
  FeatureSet map = randomFeatures(24, 4);
  FeatureSet view = map;
  for (std::size_t i = 0; i < 24; ++i) {
    // 12 agree on 0; 6 lie 29 px off (within 1.5 bins of 20 px); 6 lie 31 px off.
    view.keypoints[i].x -= i < 12 ? 0.0F : (i < 18 ? 29.0F : 31.0F);
  }
  const auto result = HistogramRegistration().registerView(map, view);
  EXPECT_EQ(result.inliers, 18);
  EXPECT_NEAR(*result.displacement_px, 6 * 29.0 / 18, 1e-4);
  EXPECT_EQ(result.states[0], FeatureState::kMatchedCorrectly);
  EXPECT_EQ(result.states[15], FeatureState::kMatchedCorrectly);
  EXPECT_EQ(result.states[20], FeatureState::kMatchedIncorrectly);
}

TEST(Registration, survivesOutliersAndUnmatchedFeatures) {
  FeatureSet map = randomFeatures(300, 5);
  FeatureSet view = moved(map, -80.0F);
  std::mt19937 random(6);
  std::uniform_real_distribution<float> anywhere(0.0F, 750.0F);
  for (std::size_t i = 0; i < 150; ++i) {
    view.keypoints[i].x = anywhere(random);
  }
  for (std::size_t i = 150; i < 220; ++i) {
    view.descriptors[i] = randomDescriptor(random);
  }
  const auto result = HistogramRegistration().registerView(map, view);
  ASSERT_TRUE(result.displacement_px);
  EXPECT_NEAR(*result.displacement_px, 80.0, 5.0);
  for (std::size_t i = 220; i < 300; ++i) {
    EXPECT_EQ(result.states[i], FeatureState::kMatchedCorrectly);
  }
  EXPECT_EQ(std::count(result.states.begin() + 150, result.states.begin() + 220, FeatureState::kNotMatched),
            70);
}

TEST(Registration, ratioTestMatchesABruteForceOracle) {
  const FeatureSet map = randomFeatures(120, 7);
  FeatureSet view = randomFeatures(150, 8);
  std::mt19937 random(9);
  for (std::size_t i = 0; i < 100; ++i) {  // noisy copies at all distances
    view.descriptors[i] = map.descriptors[i];
    for (std::size_t flip = 0; flip < i; ++flip) {
      view.descriptors[i].words[random() % 4] ^= std::uint64_t{1} << (random() % 64);
    }
  }
  RegistrationSettings settings;
  settings.max_vertical_px = 10000.0;
  const auto result = HistogramRegistration(settings).registerView(map, view);
  for (std::size_t i = 0; i < map.size(); ++i) {
    std::vector<std::pair<int, int>> ordered;
    for (std::size_t j = 0; j < view.size(); ++j) {
      ordered.emplace_back(hammingDistance(map.descriptors[i], view.descriptors[j]), static_cast<int>(j));
    }
    std::sort(ordered.begin(), ordered.end());
    const int expected = ordered[0].first < settings.ratio * ordered[1].first ? ordered[0].second : -1;
    EXPECT_EQ(result.partners[i], expected);
  }
}

TEST(Registration, dropsPairsOutsideOfTheVerticalGate) {
  const FeatureSet map = randomFeatures(40, 10);
  RegistrationSettings settings;
  const auto inside = HistogramRegistration(settings).registerView(map, moved(map, 0.0F, 49.9F));
  EXPECT_EQ(inside.inliers, 40);
  const auto outside = HistogramRegistration(settings).registerView(map, moved(map, 0.0F, 50.1F));
  EXPECT_FALSE(outside.displacement_px);
  EXPECT_EQ(outside.matches, 0);
  EXPECT_EQ(outside.states, std::vector<FeatureState>(40, FeatureState::kNotMatched));
}

TEST(Registration, degenerateInputGivesNoDisplacement) {
  const HistogramRegistration registration;
  const FeatureSet none;
  const FeatureSet one = randomFeatures(1, 11);
  const FeatureSet many = randomFeatures(50, 12);
  for (const auto* map : {&none, &one, &many}) {
    for (const auto* view : {&none, &one}) {
      const auto result = registration.registerView(*map, *view);
      EXPECT_FALSE(result.displacement_px);
      EXPECT_EQ(result.states.size(), map->size());
      EXPECT_EQ(result.partners.size(), map->size());
      EXPECT_EQ(result.inliers, 0) << "a ratio needs a second neighbour";
      EXPECT_EQ(result.histogram.counts.size() % 2, 1U);
    }
  }
}

TEST(Registration, identicalDescriptorsAreAmbiguous) {
  FeatureSet map = randomFeatures(20, 13);
  for (auto& descriptor : map.descriptors) {
    descriptor = map.descriptors[0];
  }
  const auto result = HistogramRegistration().registerView(map, map);
  EXPECT_EQ(result.matches, 0) << "0 < 0.7 * 0 does not hold";
  EXPECT_FALSE(result.displacement_px);
}

TEST(Registration, needsMinInliers) {
  const FeatureSet map = randomFeatures(5, 14);
  RegistrationSettings settings;
  settings.min_inliers = 5;
  EXPECT_TRUE(HistogramRegistration(settings).registerView(map, map).displacement_px);
  settings.min_inliers = 6;
  const auto result = HistogramRegistration(settings).registerView(map, map);
  EXPECT_FALSE(result.displacement_px);
  EXPECT_EQ(result.inliers, 5) << "reported even when too few";
  EXPECT_EQ(result.states, std::vector<FeatureState>(5, FeatureState::kMatchedIncorrectly));
}

TEST(Registration, tiesGoToTheFullerNeighbourhoodThenToZero) {
  FeatureSet map = randomFeatures(21, 15);
  FeatureSet view = map;
  const auto put = [&](std::size_t from, std::size_t to, float difference) {
    for (std::size_t i = from; i < to; ++i) {
      view.keypoints[i].x = map.keypoints[i].x - difference;
    }
  };
  put(0, 8, -100.0F);
  put(8, 16, 100.0F);
  put(16, 21, 80.0F);
  EXPECT_GT(*HistogramRegistration().registerView(map, view).displacement_px, 0.0)
      << "+100 has the neighbours";
  put(16, 21, 300.0F);
  put(0, 8, -60.0F);
  EXPECT_NEAR(*HistogramRegistration().registerView(map, view).displacement_px, -60.0, 1e-3)
      << "nearer to zero";
}

TEST(Registration, settingsAreChecked) {
  ParameterReader good({{"ratio", 0.8}, {"min_inliers", 9}});
  const auto settings = RegistrationSettings::load(good);
  EXPECT_EQ(settings.ratio, 0.8);
  EXPECT_EQ(settings.min_inliers, 9);
  EXPECT_NO_THROW(good.requireAllUsed());
  ParameterReader bad({{"bin_width_px", 0.0}});
  EXPECT_THROW(RegistrationSettings::load(bad), ParameterError);
}

}  // namespace
}  // namespace perennial
