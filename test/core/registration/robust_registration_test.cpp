#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "perennial/core/error.h"
#include "perennial/core/registration.h"

namespace perennial {
namespace {

class Scene {
 public:
  explicit Scene(unsigned seed) : random_(seed) {}

  FeatureSet features(std::size_t n) {
    FeatureSet result;
    for (std::size_t i = 0; i < n; ++i) {
      Descriptor descriptor;
      for (auto& word : descriptor.words) {
        word = (std::uint64_t{random_()} << 32) | random_();
      }
      result.add({uniform(30.0F, 720.0F), uniform(30.0F, 450.0F), 2.0F, 0.1F}, descriptor);
    }
    return result;
  }

  /// Moved by `dx` px to the right, with noise of up to 2 px and `flips` bits each.
  FeatureSet seenAgain(FeatureSet features, float dx, int flips) {
    for (std::size_t i = 0; i < features.size(); ++i) {
      features.keypoints[i].x += dx + uniform(-2.0F, 2.0F);
      features.keypoints[i].y += uniform(-2.0F, 2.0F);
      for (int flip = 0; flip < flips; ++flip) {
        const auto bit = random_() % Descriptor::kBits;
        features.descriptors[i].words[bit / 64] ^= std::uint64_t{1} << (bit % 64);
      }
    }
    return features;
  }

  float uniform(float from, float to) {
    return from + (to - from) * static_cast<float>(static_cast<double>(random_()) / 4294967296.0);
  }

 private:
  std::mt19937 random_;
};

void append(FeatureSet& set, const FeatureSet& more) {
  for (std::size_t i = 0; i < more.size(); ++i) {
    set.add(more.keypoints[i], more.descriptors[i]);
  }
}

RegistrationSettings robust() {
  RegistrationSettings settings;
  settings.method = RegistrationMethod::kRobust;
  return settings;
}

TEST(RobustRegistration, findsTheDisplacementToAFractionOfAPixel) {
  Scene scene(1);
  const FeatureSet map = scene.features(300);
  const auto result = makeRegistration(robust())->registerView(map, scene.seenAgain(map, 37.4F, 10));
  ASSERT_TRUE(result.displacement_px);
  EXPECT_NEAR(*result.displacement_px, -37.4, 0.5);
  EXPECT_GT(result.confidence, 0.9);
  // The noise put in deviates by 1.2 px; votes by chance widen the peak.
  EXPECT_GT(result.uncertainty_px, 4.0 / std::sqrt(12.0));
  EXPECT_LT(result.uncertainty_px, 5.0);
  EXPECT_GE(result.inliers, 295);
}

TEST(RobustRegistration, findsFewFeaturesOfTheSameSceneAmongMany) {
  // 90 of 500 features are seen again, with a fifth of their bits changed: the ratio test keeps hardly any of
  // them.
  Scene scene(2);
  const FeatureSet common = scene.features(90);
  FeatureSet map = common;
  FeatureSet view = scene.seenAgain(common, -120.0F, 60);
  append(map, scene.features(410));
  append(view, scene.features(410));
  const auto result = RobustRegistration(robust()).registerView(map, view);
  ASSERT_TRUE(result.displacement_px);
  EXPECT_NEAR(*result.displacement_px, 120.0, 2.0);
  int correct = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    correct += result.states[i] == FeatureState::kMatchedCorrectly && i < 90 ? 1 : 0;
    EXPECT_EQ(result.partners[i] >= 0, result.states[i] != FeatureState::kNotMatched);
  }
  EXPECT_GE(correct, 70);
}

TEST(RobustRegistration, isAntisymmetric) {
  Scene scene(3);
  const FeatureSet map = scene.features(120);
  for (float dx = -60.0F; dx <= 60.0F; dx += 7.5F) {
    const FeatureSet view = scene.seenAgain(map, dx, 20);
    const auto right = RobustRegistration(robust()).registerView(map, view);
    const auto left = RobustRegistration(robust()).registerView(view, map);
    ASSERT_TRUE(right.displacement_px && left.displacement_px);
    EXPECT_NEAR(*right.displacement_px, -*left.displacement_px, 1e-9);
    EXPECT_NEAR(right.confidence, left.confidence, 1e-12);
    EXPECT_EQ(right.inliers, left.inliers);
  }
}

TEST(RobustRegistration, confidenceFallsWithTheShareSeenAgain) {
  Scene scene(4);
  double before = 1.0;
  for (const std::size_t common : {300U, 60U, 0U}) {
    const FeatureSet shared = scene.features(common);
    FeatureSet map = shared;
    FeatureSet view = scene.seenAgain(shared, 20.0F, 40);
    append(map, scene.features(400 - common));
    append(view, scene.features(400 - common));
    const auto result = RobustRegistration(robust()).registerView(map, view);
    EXPECT_GE(result.confidence, 0.0);
    EXPECT_LT(result.confidence, before);
    before = result.confidence;
  }
  EXPECT_LT(before, 0.6) << "nothing is seen again";
}

TEST(RobustRegistration, aLeastConfidenceIsKept) {
  Scene scene(5);
  const FeatureSet map = scene.features(300);
  const FeatureSet other = scene.features(300);
  RegistrationSettings settings = robust();
  settings.min_confidence = 0.9;
  settings.min_inliers = 1;
  EXPECT_FALSE(RobustRegistration(settings).registerView(map, other).displacement_px);
  EXPECT_TRUE(RobustRegistration(settings).registerView(map, map).displacement_px);
  settings.method = RegistrationMethod::kHistogram;
  EXPECT_TRUE(makeRegistration(settings)->registerView(map, map).displacement_px);
}

TEST(RobustRegistration, onlyTheGateCounts) {
  Scene scene(6);
  const FeatureSet map = scene.features(200);
  FeatureSet view = map;
  for (Keypoint& keypoint : view.keypoints) {
    keypoint.y += 600.0F;
  }
  const auto result = RobustRegistration(robust()).registerView(map, view);
  EXPECT_FALSE(result.displacement_px);
  EXPECT_EQ(result.matches, 0);
  EXPECT_EQ(result.confidence, 0.0);
}

TEST(RobustRegistration, degenerateInputGivesNoDisplacement) {
  Scene scene(7);
  const FeatureSet none;
  const FeatureSet one = scene.features(1);
  const FeatureSet many = scene.features(50);
  for (const auto& [map, view] : std::vector<std::pair<FeatureSet, FeatureSet>>{
           {none, none}, {none, many}, {many, none}, {one, one}, {many, one}, {one, many}}) {
    const auto result = RobustRegistration(robust()).registerView(map, view);
    EXPECT_FALSE(result.displacement_px);
    EXPECT_EQ(result.states.size(), map.size());
    EXPECT_EQ(result.partners.size(), map.size());
    EXPECT_TRUE(std::isfinite(result.confidence) && std::isfinite(result.uncertainty_px));
    EXPECT_EQ(result.histogram.counts.size() % 2, 1U);
  }
}

TEST(RobustRegistration, aUsedWorkspaceChangesNothing) {
  Scene scene(8);
  const FeatureSet map = scene.features(150);
  const FeatureSet view = scene.seenAgain(map, 12.0F, 30);
  for (const auto method : {RegistrationMethod::kHistogram, RegistrationMethod::kRobust}) {
    RegistrationSettings settings;
    settings.method = method;
    const auto registration = makeRegistration(settings);
    const auto fresh = registration->registerView(map, view);
    RegistrationWorkspace workspace;
    RegistrationResult result;
    registration->registerInto(scene.features(400), scene.features(300), workspace, result);
    registration->registerInto(map, view, workspace, result);
    EXPECT_EQ(result.displacement_px, fresh.displacement_px);
    EXPECT_EQ(result.states, fresh.states);
    EXPECT_EQ(result.partners, fresh.partners);
    EXPECT_EQ(result.histogram.counts, fresh.histogram.counts);
    EXPECT_EQ(result.confidence, fresh.confidence);
  }
}

TEST(RegistrationSettings, chooseTheMethod) {
  ParameterReader reader({{"method", std::string("robust")}, {"min_confidence", 0.25}});
  RegistrationSettings settings = RegistrationSettings::load(reader);
  EXPECT_EQ(settings.method, RegistrationMethod::kRobust);
  EXPECT_EQ(settings.min_confidence, 0.25);
  EXPECT_NE(dynamic_cast<RobustRegistration*>(makeRegistration(settings).get()), nullptr);
  EXPECT_NE(dynamic_cast<RobustRegistration*>(makeRegistration({}).get()), nullptr) << "the default";
  settings.method = RegistrationMethod::kHistogram;
  EXPECT_NE(dynamic_cast<HistogramRegistration*>(makeRegistration(settings).get()), nullptr);
  ParameterReader wrong({{"method", std::string("magic")}});
  EXPECT_THROW(RegistrationSettings::load(wrong), ParameterError);
  EXPECT_FALSE(registrationMethod("magic"));
}

}  // namespace
}  // namespace perennial
