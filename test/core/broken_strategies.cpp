// Strategies each of which breaks one promise, and one that keeps them all, under the conformance suite. The
// program is meant to fail: conformance_suite_test runs it and checks that every one of them is found.
#include <cmath>
#include <limits>
#include <numeric>

#include "perennial/core/map_update.h"
#include "perennial/testing/strategy_conformance.h"

namespace perennial::test_tools {
namespace {

/// Replaces the oldest feature by the newest one seen.
class Healthy : public MapStrategy {
 public:
  std::string name() const override { return "healthy"; }
  std::size_t numbersPerFeature() const override { return 1; }
  void update(LocalMap& map, const Observation& observation) const override {
    std::vector<std::size_t> incoming = newFeatures(map, observation);
    incoming.resize(std::min<std::size_t>(incoming.size(), 1));
    exchangeFeatures(map, observation, std::vector<std::size_t>(std::min<std::size_t>(map.size(), 1), 0),
                     incoming, map.size());
  }
};

class GrowsWithoutEnd : public Healthy {
  void update(LocalMap& map, const Observation& observation) const override {
    insertFromView(map, observation, newFeatures(map, observation));
  }
};

class UsesWhatIsNotThere : public Healthy {
  Alternatives alternatives(const LocalMap& map, double) const override { return {{map.size()}}; }
};

class UsesInNoOrder : public Healthy {
  Alternatives alternatives(const LocalMap& map, double) const override {
    std::vector<std::size_t> all(map.size());
    std::iota(all.rbegin(), all.rend(), std::size_t{0});
    return {all};
  }
};

class OffersNothing : public Healthy {
  Alternatives alternatives(const LocalMap&, double) const override { return {}; }
};

class RemembersOutsideOfTheMap : public Healthy {
  void update(LocalMap& map, const Observation& observation) const override {
    if (++updates_ > 5) {
      Healthy::update(map, observation);
    }
  }
  mutable int updates_ = 0;
};

class DrawsUnseededNumbers : public Healthy {
  void update(LocalMap& map, const Observation& observation) const override {
    static unsigned state = 1;
    state = state * 1664525U + 1013904223U;
    std::fill(map.numbers.begin(), map.numbers.end(), state >> 16U);
    Healthy::update(map, observation);
  }
};

class ForgetsWhatIsNotSeen : public Healthy {
  void update(LocalMap& map, const Observation& observation) const override {
    std::vector<bool> drop(map.size(), false);
    if (observation.view.empty() && !drop.empty()) {
      drop.front() = true;
    }
    map.erase(drop);
  }
};

class DropsEverything : public Healthy {
  void update(LocalMap& map, const Observation&) const override {
    map.erase(std::vector<bool>(map.size(), true));
  }
};

class GetsOutOfStep : public Healthy {
  void update(LocalMap& map, const Observation& observation) const override {
    Healthy::update(map, observation);
    map.numbers.push_back(0.0);
  }
};

class WritesNaN : public Healthy {
  void update(LocalMap& map, const Observation& observation) const override {
    Healthy::update(map, observation);
    map.map_numbers = {std::numeric_limits<double>::quiet_NaN()};
  }
};

class GivesIdentitiesAgain : public Healthy {
  void update(LocalMap& map, const Observation& observation) const override {
    // What it adds it drops again, and gives the identity back.
    const std::uint32_t next_id = map.next_id;
    Healthy::update(map, observation);
    std::vector<bool> drop(map.size());
    for (std::size_t i = 0; i < map.size(); ++i) {
      drop[i] = map.size() > 20 && map.ids[i] >= next_id;
    }
    map.erase(drop);
    map.next_id = next_id == 0 ? 0 : next_id - 1;
  }
};

class ChangesDescriptors : public Healthy {
  void update(LocalMap& map, const Observation& observation) const override {
    Healthy::update(map, observation);
    if (!map.features.empty()) {
      map.features.descriptors.front().words[0] ^= 1U;
    }
  }
};

class InventsFeatures : public Healthy {
  void update(LocalMap& map, const Observation& observation) const override {
    Healthy::update(map, observation);
    std::vector<bool> drop(map.size());
    if (!drop.empty()) {
      drop.front() = true;
      map.erase(drop);
      map.add({1.0F, 1.0F, 1.0F, 1.0F}, Descriptor());
    }
  }
};

class MovesThePlace : public Healthy {
  void update(LocalMap& map, const Observation& observation) const override {
    Healthy::update(map, observation);
    map.distance_m += 1e-3;
  }
};

class CannotGoBackInTime : public Healthy {
  void update(LocalMap& map, const Observation& observation) const override {
    if (observation.stamp_s < map.stamp_s) {
      throw Error("before it was taught");
    }
    Healthy::update(map, observation);
  }
};

class HasNoName : public Healthy {
  std::string name() const override { return ""; }
};

class SwallowsParameters : public Healthy {
  void configure(ParameterReader& reader) override {
    reader.integer("no_strategy_has_this_parameter", 0, 0, 9);
  }
};

#define BROKEN(strategy) \
  INSTANTIATE_TEST_SUITE_P(strategy, StrategyConformance, ::testing::Values(strategyUnderTest<strategy>()))
BROKEN(Healthy);
BROKEN(GrowsWithoutEnd);
BROKEN(UsesWhatIsNotThere);
BROKEN(UsesInNoOrder);
BROKEN(OffersNothing);
BROKEN(RemembersOutsideOfTheMap);
BROKEN(DrawsUnseededNumbers);
BROKEN(ForgetsWhatIsNotSeen);
BROKEN(DropsEverything);
BROKEN(GetsOutOfStep);
BROKEN(WritesNaN);
BROKEN(GivesIdentitiesAgain);
BROKEN(ChangesDescriptors);
BROKEN(InventsFeatures);
BROKEN(MovesThePlace);
BROKEN(CannotGoBackInTime);
BROKEN(HasNoName);
BROKEN(SwallowsParameters);

}  // namespace
}  // namespace perennial::test_tools
