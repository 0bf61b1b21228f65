#include "plants.h"

#include <algorithm>
#include <cmath>

#include "mesh.h"
#include "perennial/park/random.h"

namespace perennial::park {
namespace {

constexpr double kTurn = 2.0 * 3.14159265358979323846;

Vec3 unit(Vec3 vector) {
  vector.normalize();
  return vector;
}

Vec3 randomDirection(Random& random) {
  const double z = random.uniform(-1.0, 1.0);
  const double angle = random.uniform(0.0, kTurn);
  const double radius = std::sqrt(1.0 - z * z);
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

Colour scaled(const Colour& colour, double factor) {
  return {colour[0] * factor, colour[1] * factor, colour[2] * factor};
}

/// Builds one plant.
class Gardener {
 public:
  Gardener(const Plant& plant, double ground_m, const Conditions& conditions, const Season& season)
      : plant_(plant),
        root_(plant.x, plant.y, ground_m - 0.1),
        conditions_(conditions),
        season_(season),
        nature_(mix({plant.seed, 1})),
        tint_(nature_.uniform(0.75, 1.25)) {}

  osg::ref_ptr<osg::Geometry> grow() {
    switch (plant_.kind) {
      case PlantKind::kBroadleaf:
        growBroadleaf();
        break;
      case PlantKind::kConifer:
        growConifer();
        break;
      case PlantKind::kShrub:
        growShrub();
        break;
    }
    return mesh_.geometry();
  }

 private:
  void growBroadleaf() {
    const double height = plant_.height_m;
    const double thickness = 0.022 * height * nature_.uniform(0.8, 1.3);
    const Vec3 lean(nature_.uniform(-0.3, 0.3), nature_.uniform(-0.3, 0.3), 0.0);
    const Vec3 top = root_ + Vec3(0, 0, 0.75 * height) + lean;
    const Colour bark = scaled({0.10, 0.085, 0.065}, nature_.uniform(0.7, 2.0));
    addTube(mesh_, root_, top, thickness, 0.2 * thickness, plant_.detail == 2 ? 9 : 5, Tile::kBark, bark);
    const Vec3 middle = root_ + Vec3(0, 0, 0.64 * height) + lean * 0.8;
    const Vec3 radii(plant_.crown_radius_m, plant_.crown_radius_m, 0.34 * height);
    const int boughs = plant_.detail == 2 ? 9 : plant_.detail == 1 ? 5 : 0;
    for (int i = 0; i < boughs; ++i) {
      const double share = nature_.uniform(0.35, 0.85);
      const Vec3 direction = randomDirection(nature_);
      const Vec3 end =
          middle +
          Vec3(direction.x() * radii.x(), direction.y() * radii.y(), direction.z() * radii.z()) * 0.8;
      addTube(mesh_, root_ + (top - root_) * share, end, 0.4 * thickness, 0.008, 4, Tile::kBark, bark);
    }
    static constexpr int kClusters[] = {34, 70, 170};
    static constexpr double kSizeM[] = {2.5, 1.35, 0.85};
    for (int i = 0; i < kClusters[plant_.detail]; ++i) {
      addCluster(i, middle, radii, kSizeM[plant_.detail]);
    }
  }

  void growShrub() {
    const double radius = plant_.crown_radius_m;
    const Vec3 middle = root_ + Vec3(0, 0, 0.45 * plant_.height_m);
    const Vec3 radii(radius, radius, 0.55 * plant_.height_m);
    for (int i = 0; i < 5; ++i) {
      addTube(mesh_, root_, middle + randomDirection(nature_) * (0.6 * radius), 0.02, 0.006, 4, Tile::kBark,
              {0.09, 0.07, 0.05});
    }
    const int clusters = plant_.detail == 2 ? 55 : 30;
    for (int i = 0; i < clusters; ++i) {
      addCluster(i, middle, radii, (plant_.detail == 2 ? 0.55 : 0.75) * radius);
    }
  }

  void growConifer() {
    const double height = plant_.height_m;
    addTube(mesh_, root_, root_ + Vec3(0, 0, height), 0.018 * height, 0.02, 6, Tile::kBark,
            {0.07, 0.05, 0.04});
    static constexpr int kBoughs[] = {50, 90, 190};
    const int count = kBoughs[plant_.detail];
    for (int i = 0; i < count; ++i) {
      const double share = 0.08 + 0.9 * (i + nature_.uniform()) / count;
      const double angle =
          i * 2.39996 + nature_.uniform(-0.3, 0.3);  // the golden angle spreads boughs evenly
      addBough(share, angle, plant_.crown_radius_m * (1.05 - share) * nature_.uniform(0.8, 1.15));
    }
  }

  /// A bough of needles: a quad from the trunk outwards and down.
  void addBough(double share, double angle, double reach) {
    const Vec3 out(std::cos(angle), std::sin(angle), 0.0);
    const double twist = nature_.uniform(-0.7, 0.7);
    const Vec3 across = unit(Vec3(-out.y(), out.x(), twist)) * (0.55 * reach);
    const Vec3 from = root_ + Vec3(0, 0, plant_.height_m * share);
    const Vec3 to = from + out * reach - Vec3(0, 0, reach * nature_.uniform(0.25, 0.6));
    const Colour green = scaled({0.035, 0.062, 0.03}, tint_ * nature_.uniform(0.7, 1.4));
    const Vec3 normal = unit(out + Vec3(0, 0, 0.9));
    const auto corner = [&](const Vec3& position, double u, double v, double sway) {
      const auto uv = atlasCoordinates(Tile::kNeedles, u, v);
      return Mesh::Vertex{position, normal, uv[0], uv[1], green, sway};
    };
    mesh_.quad(corner(from - across, 0.0, 0.0, 0.0), corner(from + across, 1.0, 0.0, 0.0),
               corner(to + across, 1.0, 1.0, 0.5), corner(to - across, 0.0, 1.0, 0.5));
  }

  /// One cluster of leaves, or bare twigs where they have fallen.
  void addCluster(std::int64_t index, const Vec3& middle, const Vec3& radii, double size_m) {
    constexpr std::int64_t kPeriodDays = 60;
    Random fate(mix({plant_.seed, index, 2}));
    const std::int64_t epoch = (conditions_.day() + fate.below(kPeriodDays)) / kPeriodDays;
    Random place(mix({plant_.seed, index, epoch, 3}));
    Random today(mix({plant_.seed, index, conditions_.day(), 4}));
    const bool leafy = fate.uniform() < season_.leaf_density;
    const Vec3 direction = randomDirection(place);
    const double depth = 0.45 + 0.6 * std::cbrt(place.uniform());
    const double jitter = 0.01 * std::min(conditions_.wind_m_s, 10.0) * size_m;
    const Vec3 offset(direction.x() * radii.x(), direction.y() * radii.y(), direction.z() * radii.z());
    const Vec3 position = middle + offset * depth + randomDirection(today) * jitter;
    // Further inside a crown less light of the sky arrives; below, less still.
    const double light =
        std::clamp(0.25 + 0.75 * (depth - 0.45) / 0.55, 0.2, 1.0) * (0.8 + 0.25 * direction.z());
    const double size = size_m * place.uniform(0.75, 1.3) * (leafy ? 1.0 : 1.15);
    const Colour colour = leafy ? leafColour(fate) : scaled({0.085, 0.07, 0.055}, fate.uniform(0.8, 1.6));
    if (leafy || fate.uniform() < 0.7) {
      addSprite(position, unit(direction + randomDirection(place) * 0.9), unit(direction + Vec3(0, 0, 0.5)),
                size, leafy ? Tile::kLeaves : Tile::kTwigs, scaled(colour, light), place.uniform(0.0, kTurn));
    }
  }

  Colour leafColour(Random& fate) const {
    static constexpr Colour kTurned[] = {
        {0.42, 0.30, 0.03}, {0.38, 0.16, 0.02}, {0.24, 0.05, 0.02}, {0.20, 0.12, 0.05}};
    const bool turned =
        0.65 * fate.uniform() + 0.35 * Random(mix({plant_.seed, 7})).uniform() < season_.leaf_turned;
    if (turned) {
      const auto favourite = static_cast<int>(static_cast<std::uint64_t>(plant_.seed) % 4);
      return scaled(kTurned[fate.uniform() < 0.7 ? favourite : fate.below(4)], fate.uniform(0.7, 1.3));
    }
    const double fresh = season_.bud_freshness;
    const Colour green = {0.055 + 0.08 * fresh, 0.115 + 0.08 * fresh, 0.022 + 0.01 * fresh};
    return scaled(green, tint_ * fate.uniform(0.7, 1.4));
  }

  void addSprite(const Vec3& middle, const Vec3& facing, const Vec3& normal, double size, Tile tile,
                 const Colour& colour, double roll) {
    const Vec3 side = unit(facing ^ (std::abs(facing.z()) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0)));
    const Vec3 other = facing ^ side;
    const Vec3 right = (side * std::cos(roll) + other * std::sin(roll)) * (0.5 * size);
    const Vec3 up = (other * std::cos(roll) - side * std::sin(roll)) * (0.5 * size);
    const auto corner = [&](double u, double v) {
      const auto uv = atlasCoordinates(tile, u, v);
      return Mesh::Vertex{
          middle + right * (2.0 * u - 1.0) - up * (2.0 * v - 1.0), normal, uv[0], uv[1], colour, 1.0};
    };
    mesh_.quad(corner(0.0, 1.0), corner(1.0, 1.0), corner(1.0, 0.0), corner(0.0, 0.0));
  }

  const Plant& plant_;
  Vec3 root_;
  const Conditions& conditions_;
  const Season& season_;
  Random nature_;  ///< what never changes about this plant
  double tint_;
  Mesh mesh_;
};

}  // namespace

osg::ref_ptr<osg::Geometry> makePlant(const Plant& plant, double ground_m, const Conditions& conditions,
                                      const Season& season) {
  return Gardener(plant, ground_m, conditions, season).grow();
}

}  // namespace perennial::park
