#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "perennial/core/feature.h"
#include "perennial/core/local_map.h"
#include "perennial/core/map_strategy.h"
#include "perennial/core/registration.h"

namespace perennial::test_tools {

/// A place as features only: landmarks of which some are always there and others by day or by night only,
/// seen displaced, with noise in position and descriptor, among clutter that is never seen again. What tests
/// of strategies learn from. Depends on its seed only, on every platform (no distribution of the standard
/// library is used).
class SyntheticPlace {
 public:
  explicit SyntheticPlace(unsigned seed, std::size_t landmarks = 150) : random_(seed) {
    for (std::size_t i = 0; i < landmarks; ++i) {
      landmarks_.add(
          {static_cast<float>(uniform(100.0, 650.0)), static_cast<float>(uniform(30.0, 450.0)), 2.0F, 0.1F},
          randomDescriptor());
    }
  }

  /// What a camera sees at this time, about `features` features: landmarks moved by `dx` to the right, and
  /// clutter.
  FeatureSet view(double stamp_s, double dx, std::size_t features) {
    const bool day = static_cast<std::int64_t>(stamp_s / 43200.0) % 2 == 0;
    FeatureSet seen;
    for (std::size_t i = 0; i < landmarks_.size() && seen.size() < features * 4 / 5; ++i) {
      const std::size_t kind = i % 3;  // always there, by day, by night
      const bool there = kind == 0 || (kind == 1) == day;
      if (there && uniform(0.0, 1.0) < 0.8) {
        Keypoint keypoint = landmarks_.keypoints[i];
        keypoint.x += static_cast<float>(dx + uniform(-1.0, 1.0));
        keypoint.y += static_cast<float>(uniform(-1.0, 1.0));
        seen.add(keypoint, noisy(landmarks_.descriptors[i]));
      }
    }
    while (seen.size() < features) {
      seen.add(
          {static_cast<float>(uniform(0.0, 752.0)), static_cast<float>(uniform(0.0, 480.0)), 2.0F, 0.05F},
          randomDescriptor());
    }
    return seen;
  }

  /// A local map taught from a view at this time.
  LocalMap teach(double stamp_s, std::size_t features) {
    LocalMap map;
    map.index = 3;
    map.distance_m = 0.6;
    map.stamp_s = stamp_s;
    const FeatureSet seen = view(stamp_s, 0.0, features);
    for (std::size_t i = 0; i < seen.size(); ++i) {
      map.add(seen.keypoints[i], seen.descriptors[i]);
    }
    return map;
  }

  /// Uniform in [from, to).
  double uniform(double from, double to) {
    return from + (to - from) * (static_cast<double>(random_()) / 4294967296.0);
  }

 private:
  Descriptor randomDescriptor() {
    Descriptor descriptor;
    for (auto& word : descriptor.words) {
      word = (std::uint64_t{random_()} << 32) | random_();
    }
    return descriptor;
  }

  Descriptor noisy(Descriptor descriptor) {
    for (int flip = 0; flip < 12; ++flip) {
      const auto bit = random_() % Descriptor::kBits;
      descriptor.words[bit / 64] ^= std::uint64_t{1} << (bit % 64);
    }
    return descriptor;
  }

  std::mt19937 random_;
  FeatureSet landmarks_;
};

/// The features at these positions; a position beyond the map throws std::out_of_range.
inline FeatureSet selected(const FeatureSet& features, const std::vector<std::size_t>& positions) {
  FeatureSet result;
  for (const std::size_t i : positions) {
    result.add(features.keypoints.at(i), features.descriptors.at(i));
  }
  return result;
}

/// Registers a view against every alternative; of the results the one with the most inliers, of several the
/// first.
inline Observation observe(const MapStrategy& strategy, const LocalMap& map, FeatureSet view,
                           double stamp_s) {
  const auto registration = makeRegistration({});
  Observation best;
  bool first = true;
  for (const std::vector<std::size_t>& used : strategy.alternatives(map, stamp_s)) {
    RegistrationResult result = registration->registerView(selected(map.features, used), view);
    if (first || result.inliers > best.registration.inliers) {
      best.registration = std::move(result);
      best.used = used;
      first = false;
    }
  }
  best.view = std::move(view);
  best.stamp_s = stamp_s;
  best.distance_m = map.distance_m;
  return best;
}

}  // namespace perennial::test_tools
