#include "core/registration/edge_correlation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "perennial/core/registration.h"

namespace perennial {
namespace {

EdgeField randomField(int columns, int rows, unsigned seed) {
  std::mt19937 random(seed);
  EdgeField field;
  field.cell_px = 8;
  field.columns = columns;
  field.rows = rows;
  for (int i = 0; i < 2 * columns * rows; ++i) {
    field.values.push_back(static_cast<std::int8_t>(static_cast<int>(random() % 101) - 50));
  }
  return field;
}

/// Part of a field.
EdgeField part(const EdgeField& field, int x, int y, int columns, int rows) {
  EdgeField result = field;
  result.columns = columns;
  result.rows = rows;
  result.values.clear();
  for (int row = y; row < y + rows; ++row) {
    const auto begin = field.values.begin() + 2 * (row * field.columns + x);
    result.values.insert(result.values.end(), begin, begin + 2 * columns);
  }
  return result;
}

double highestAt(const EdgeCorrelation& correlation) {
  const auto& profile = correlation.profile();
  const auto best = std::max_element(profile.begin(), profile.end()) - profile.begin();
  return (static_cast<double>(best) - static_cast<double>(profile.size() / 2)) * correlation.step_px();
}

/// From the definition in edge_correlation.h.
class Reference {
 public:
  Reference(const EdgeField& map, const EdgeField& view) : map_(map), view_(view) {}

  std::vector<double> profile() const {
    const int reach_x = map_.columns / 2;
    const int reach_y = std::min(96 / map_.cell_px, map_.rows / 2);
    const double scale = map_.columns * map_.rows / (norm(map_) * norm(view_));
    std::vector<double> best;
    for (int dx = -reach_x; dx <= reach_x; ++dx) {
      best.push_back(-1e9);
      for (int dy = -reach_y; dy <= reach_y; ++dy) {
        double sum = 0.0;
        for (int j = -1; j <= 1; ++j) {
          for (int i = -1; i <= 1; ++i) {
            const int x = std::clamp(dx + i, -reach_x, reach_x);
            const int y = std::clamp(dy + j, -reach_y, reach_y);
            sum += (2 - std::abs(i)) * (2 - std::abs(j)) * at(x, y) / 16.0;
          }
        }
        best.back() = std::max(best.back(), scale * sum);
      }
    }
    std::vector<double> sorted = best;
    std::sort(sorted.begin(), sorted.end());
    for (double& value : best) {
      value -= sorted[sorted.size() / 2];
    }
    return best;
  }

 private:
  static double norm(const EdgeField& field) {
    double sum = 0.0;
    for (const std::int8_t value : field.values) {
      sum += value * value;
    }
    return std::sqrt(sum);
  }

  double at(int dx, int dy) const {
    double sum = 0.0;
    int cells = 0;
    for (int y = 0; y < map_.rows; ++y) {
      for (int x = 0; x < map_.columns; ++x) {
        const int u = x - dx;
        const int v = y - dy;
        if (u < 0 || u >= map_.columns || v < 0 || v >= map_.rows) {
          continue;
        }
        const auto i = 2 * static_cast<std::size_t>(y * map_.columns + x);
        const auto j = 2 * static_cast<std::size_t>(v * map_.columns + u);
        sum += map_.values[i] * view_.values[j] + map_.values[i + 1] * view_.values[j + 1];
        ++cells;
      }
    }
    return sum / std::sqrt(static_cast<double>(cells));
  }

  const EdgeField& map_;
  const EdgeField& view_;
};

TEST(EdgeCorrelation, isWhatItsDefinitionSays) {
  for (const auto& [columns, rows] : {std::pair{1, 1}, {2, 9}, {17, 5}, {16, 31}, {33, 26}}) {
    const EdgeField map = randomField(columns, rows, 1);
    const EdgeField view = randomField(columns, rows, 2);
    EdgeCorrelation correlation;
    ASSERT_TRUE(correlation.compute(map, view));
    const std::vector<double> expected = Reference(map, view).profile();
    ASSERT_EQ(correlation.profile().size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR(correlation.profile()[i], expected[i], 1e-9) << columns << "x" << rows << " at " << i;
    }
  }
}

TEST(EdgeCorrelation, findsTheSharedPartAndItsVerticalShift) {
  const EdgeField wide = randomField(140, 80, 3);
  EdgeCorrelation correlation;
  for (const int dx : {-30, -1, 0, 7, 40}) {
    // The view looks `dx` cells further right and 10 further down: x_map - x_view is positive.
    ASSERT_TRUE(
        correlation.compute(part(wide, 40, 10, 94, 50), part(wide, std::min(40 + dx, 46), 20, 94, 50)));
    EXPECT_EQ(highestAt(correlation), 8.0 * std::min(dx, 6));
    EXPECT_GT(correlation.at(8.0 * std::min(dx, 6)), 8.0) << "deviations of chance";
  }
}

TEST(EdgeCorrelation, isLinearBetweenStepsAndZeroBeyond) {
  EdgeCorrelation correlation;
  ASSERT_TRUE(correlation.compute(randomField(20, 10, 4), randomField(20, 10, 5)));
  EXPECT_EQ(correlation.reach_px(), 80.0);
  EXPECT_EQ(correlation.at(-80.0), correlation.profile().front());
  EXPECT_EQ(correlation.at(80.0), correlation.profile().back());
  EXPECT_NEAR(correlation.at(2.0), 0.75 * correlation.profile()[10] + 0.25 * correlation.profile()[11],
              1e-12);
  EXPECT_EQ(correlation.at(80.5), 0.0);
  EXPECT_EQ(correlation.at(-1000.0), 0.0);
}

TEST(EdgeCorrelation, needsTwoFieldsOfOneLayoutWithSomethingInThem) {
  EdgeCorrelation correlation;
  const EdgeField field = randomField(20, 10, 6);
  EdgeField blank = field;
  std::fill(blank.values.begin(), blank.values.end(), std::int8_t{0});
  EXPECT_FALSE(correlation.compute({}, {}));
  EXPECT_FALSE(correlation.compute(field, {}));
  EXPECT_FALSE(correlation.compute({}, field));
  EXPECT_FALSE(correlation.compute(field, randomField(10, 20, 6)));
  EXPECT_FALSE(correlation.compute(field, blank));
  EXPECT_FALSE(correlation.compute(blank, field));
  EXPECT_TRUE(correlation.compute(field, field));
}

/// Features at random, of which as many are seen again moved by +64 px as by -64.
struct Ambiguous {
  explicit Ambiguous(unsigned seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](float to) { return to * static_cast<float>(random() % 10000) / 10000.0F; };
    for (int i = 0; i < 120; ++i) {
      Descriptor descriptor;
      for (auto& word : descriptor.words) {
        word = (std::uint64_t{random()} << 32) | random();
      }
      const Keypoint place{100.0F + uniform(500.0F), 30.0F + uniform(400.0F), 2.0F, 0.1F};
      map.add(place, descriptor);
      view.add({place.x + (i % 2 == 0 ? 64.0F : -64.0F), place.y, 2.0F, 0.1F}, descriptor);
    }
  }
  FeatureSet map;
  FeatureSet view;
};

TEST(RobustRegistration, theEdgesDecideWhatVotesLeaveOpen) {
  const EdgeField wide = randomField(110, 60, 8);
  const auto registration = makeRegistration({});
  Ambiguous scene(9);
  EXPECT_FALSE(registration->registerView(scene.map, scene.view).displacement_px);
  for (const int cells : {-8, 8}) {
    scene.map.edges = part(wide, 8, 0, 94, 60);
    scene.view.edges = part(wide, 8 + cells, 0, 94, 60);
    const RegistrationResult result = registration->registerView(scene.map, scene.view);
    ASSERT_TRUE(result.displacement_px);
    EXPECT_NEAR(*result.displacement_px, 8.0 * cells, 0.5);
    EXPECT_GT(result.confidence, 0.5);
    EXPECT_EQ(result.inliers, 60);
  }
}

TEST(RobustRegistration, edgesAloneSayNothing) {
  FeatureSet map;
  FeatureSet view;
  map.edges = view.edges = randomField(94, 60, 10);
  const RegistrationResult result = makeRegistration({})->registerView(map, view);
  EXPECT_FALSE(result.displacement_px);
  EXPECT_EQ(result.confidence, 0.0);
}

}  // namespace
}  // namespace perennial
