#include "objects.h"

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

/// Puts boxes, tubes and panels in an object's own frame: x forward, y left, z up from the ground.
class Carpenter {
 public:
  explicit Carpenter(const Object& object) : pose_(object.pose), random_(mix({object.seed, 1})) {}

  void box(const Vec3& low, const Vec3& high, Tile tile, double tile_m, const Colour& colour) {
    const Vec3 size = high - low;
    const Vec3 dx(size.x(), 0, 0), dy(0, size.y(), 0), dz(0, 0, size.z());
    panel(low, dx, dz, tile, tile_m, colour);
    panel(low + dx, dy, dz, tile, tile_m, colour);
    panel(low + dx + dy, -dx, dz, tile, tile_m, colour);
    panel(low + dy, -dy, dz, tile, tile_m, colour);
    panel(low + dz, dx, dy, tile, tile_m, colour);
  }

  /// The normal is `along` x `up`.
  void panel(const Vec3& corner, const Vec3& along, const Vec3& up, Tile tile, double tile_m,
             const Colour& colour) {
    addPanel(mesh_, place(corner), turned(along), turned(up), turned(unit(along ^ up)), tile, tile_m, colour);
  }

  void tube(const Vec3& from, const Vec3& to, double from_radius, double to_radius, Tile tile,
            const Colour& colour) {
    addTube(mesh_, place(from), place(to), from_radius, to_radius, 8, tile, colour);
  }

  void ring(const Vec3& middle, double radius, double thickness, const Colour& colour) {
    constexpr int kParts = 14;
    const auto point = [&](int i) {
      return middle + Vec3(radius * std::cos(kTurn * i / kParts), 0, radius * std::sin(kTurn * i / kParts));
    };
    for (int i = 0; i < kParts; ++i) {
      addTube(mesh_, place(point(i)), place(point(i + 1)), thickness, thickness, 4, Tile::kPlain, colour);
    }
  }

  void gable(const Vec3& a, const Vec3& b, const Vec3& top, const Colour& colour) {
    const Vec3 normal = turned(unit((b - a) ^ (top - a)));
    const auto vertex = [&](const Vec3& at, double u, double v) {
      const auto uv = atlasCoordinates(Tile::kPlanks, u, v);
      return Mesh::Vertex{place(at), normal, uv[0], uv[1], colour, 0.0};
    };
    mesh_.triangle(vertex(a, 0, 1), vertex(b, 1, 1), vertex(top, 0.5, 0));
  }

  Random& random() { return random_; }
  osg::ref_ptr<osg::Geometry> geometry() { return mesh_.geometry(); }

 private:
  Vec3 turned(const Vec3& v) const {
    const double c = std::cos(pose_.heading);
    const double s = std::sin(pose_.heading);
    return {c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z()};
  }
  Vec3 place(const Vec3& v) const { return turned(v) + Vec3(pose_.x, pose_.y, 0.0); }

  Pose pose_;
  Random random_;
  Mesh mesh_;
};

void makeHouse(Carpenter& c) {
  const Vec3 half(2.6, 2.0, 2.5);
  c.box({-half.x(), -half.y(), 0}, half, Tile::kBricks, 1.2, {0.42, 0.20, 0.13});
  c.box({-half.x() - 0.05, -half.y() - 0.05, 0}, {half.x() + 0.05, half.y() + 0.05, 0.25}, Tile::kPlain, 1.0,
        {0.3, 0.3, 0.29});
  for (const double side : {-1.0, 1.0}) {  // windows and doors on both long sides
    const double y = side * (half.y() + 0.03);
    const auto front = [&](double x0, double z0, double x1, double z1, Tile tile, const Colour& colour,
                           double lift) {
      const Vec3 corner(side < 0 ? x0 : x1, y + side * lift, z0);
      c.panel(corner, Vec3((side < 0 ? 1.0 : -1.0) * (x1 - x0), 0, 0), Vec3(0, 0, z1 - z0), tile, 1.0,
              colour);
    };
    front(-0.55, 0.25, 0.45, 2.15, Tile::kPlanks, {0.05, 0.14, 0.09}, 0.0);
    for (const double x : {-1.9, 1.0}) {
      front(x - 0.08, 0.92, x + 0.98, 2.03, Tile::kPlain, {0.75, 0.75, 0.72}, 0.0);
      front(x, 1.0, x + 0.42, 1.95, Tile::kPlain, {0.02, 0.025, 0.03}, 0.02);
      front(x + 0.48, 1.0, x + 0.9, 1.95, Tile::kPlain, {0.02, 0.025, 0.03}, 0.02);
    }
  }
  const double ridge = half.z() + 1.5;
  const double eave_y = half.y() + 0.4;
  const double eave_z = half.z() - 0.3;
  const double x = half.x() + 0.35;
  const Colour tiles = {0.30, 0.13, 0.09};
  c.panel({-x, -eave_y, eave_z}, {2 * x, 0, 0}, {0, eave_y, ridge - eave_z}, Tile::kRoof, 1.4, tiles);
  c.panel({x, eave_y, eave_z}, {-2 * x, 0, 0}, {0, -eave_y, ridge - eave_z}, Tile::kRoof, 1.4, tiles);
  c.gable({half.x(), -half.y(), half.z()}, {half.x(), half.y(), half.z()}, {half.x(), 0, ridge - 0.1},
          {0.35, 0.27, 0.18});
  c.gable({-half.x(), half.y(), half.z()}, {-half.x(), -half.y(), half.z()}, {-half.x(), 0, ridge - 0.1},
          {0.35, 0.27, 0.18});
  c.box({1.2, 0.5, 3.0}, {1.7, 1.0, 4.6}, Tile::kBricks, 1.2, {0.36, 0.2, 0.15});
}

void makeBench(Carpenter& c) {
  const Colour wood = {0.30, 0.17, 0.08};
  const Colour iron = {0.04, 0.045, 0.05};
  for (const double y : {-0.7, 0.65}) {
    c.box({-0.22, y, 0}, {-0.16, y + 0.06, 0.85}, Tile::kPlain, 0.5, iron);
    c.box({0.18, y, 0}, {0.24, y + 0.06, 0.42}, Tile::kPlain, 0.5, iron);
  }
  for (int i = 0; i < 4; ++i) {
    c.box({-0.2 + 0.12 * i, -0.85, 0.42}, {-0.11 + 0.12 * i, 0.85, 0.455}, Tile::kPlanks, 1.7, wood);
  }
  for (int i = 0; i < 3; ++i) {
    c.box({-0.24, -0.85, 0.5 + 0.13 * i}, {-0.2, 0.85, 0.6 + 0.13 * i}, Tile::kPlanks, 1.7, wood);
  }
}

void makeBin(Carpenter& c) {
  c.tube({0, 0, 0.1}, {0, 0, 0.8}, 0.22, 0.25, Tile::kPlanks, {0.06, 0.15, 0.07});
  c.tube({0, 0, 0.8}, {0, 0, 0.84}, 0.27, 0.02, Tile::kPlain, {0.05, 0.06, 0.05});
  c.tube({0, 0, 0}, {0, 0, 0.15}, 0.05, 0.05, Tile::kPlain, {0.05, 0.05, 0.05});
}

void makeLamp(Carpenter& c) {
  const Colour iron = {0.05, 0.065, 0.06};
  c.tube({0, 0, 0}, {0, 0, 0.5}, 0.10, 0.07, Tile::kPlain, iron);
  c.tube({0, 0, 0.5}, {0, 0, 3.4}, 0.05, 0.04, Tile::kPlain, iron);
  c.tube({0, 0, 3.4}, {0, 0, 3.75}, 0.10, 0.19, Tile::kPlain, {0.7, 0.7, 0.66});
  c.tube({0, 0, 3.75}, {0, 0, 3.95}, 0.24, 0.02, Tile::kPlain, iron);
}

void makeSign(Carpenter& c) {
  const Colour wood = {0.22, 0.14, 0.08};
  c.box({-0.04, -0.55, 0}, {0.04, -0.47, 1.6}, Tile::kPlanks, 1.0, wood);
  c.box({-0.04, 0.47, 0}, {0.04, 0.55, 1.6}, Tile::kPlanks, 1.0, wood);
  c.box({-0.03, -0.47, 0.75}, {0.03, 0.47, 1.5}, Tile::kPlain, 1.0, {0.55, 0.54, 0.45});
  for (int i = 0; i < 5; ++i) {
    const double z = 0.85 + 0.12 * i;
    c.box({-0.035, -0.4, z}, {0.035, -0.4 + 0.8 * c.random().uniform(0.4, 1.0), z + 0.05}, Tile::kPlain, 1.0,
          {0.07, 0.1, 0.08});
  }
}

void makeTable(Carpenter& c) {
  const Colour wood = {0.33, 0.21, 0.11};
  c.box({-0.4, -0.9, 0.7}, {0.4, 0.9, 0.75}, Tile::kPlanks, 1.0, wood);
  for (const double x : {-0.85, 0.6}) {
    c.box({x, -0.9, 0.42}, {x + 0.25, 0.9, 0.46}, Tile::kPlanks, 1.0, wood);
  }
  for (const double y : {-0.65, 0.6}) {
    c.box({-0.8, y, 0.35}, {0.8, y + 0.05, 0.42}, Tile::kPlanks, 1.0, wood);
    c.box({-0.3, y, 0}, {-0.22, y + 0.05, 0.7}, Tile::kPlanks, 1.0, wood);
    c.box({0.22, y, 0}, {0.3, y + 0.05, 0.7}, Tile::kPlanks, 1.0, wood);
  }
}

Colour gaudy(Random& random) {
  static constexpr Colour kPaints[] = {{0.5, 0.05, 0.04}, {0.05, 0.12, 0.45}, {0.6, 0.45, 0.04},
                                       {0.6, 0.6, 0.58},  {0.04, 0.3, 0.12},  {0.05, 0.05, 0.06}};
  return kPaints[random.below(6)];
}

void makeBicycle(Carpenter& c) {
  const Colour paint = gaudy(c.random());
  const Colour rubber = {0.03, 0.03, 0.03};
  c.ring({-0.52, 0, 0.34}, 0.33, 0.02, rubber);
  c.ring({0.52, 0, 0.34}, 0.33, 0.02, rubber);
  const Vec3 saddle(-0.18, 0, 0.85), pedal(-0.05, 0, 0.3), head(0.38, 0, 0.82);
  c.tube(pedal, saddle, 0.02, 0.02, Tile::kPlain, paint);
  c.tube(pedal, head, 0.025, 0.025, Tile::kPlain, paint);
  c.tube(saddle, head, 0.02, 0.02, Tile::kPlain, paint);
  c.tube({-0.52, 0, 0.34}, saddle, 0.015, 0.015, Tile::kPlain, paint);
  c.tube({-0.52, 0, 0.34}, pedal, 0.015, 0.015, Tile::kPlain, paint);
  c.tube({0.52, 0, 0.34}, {0.34, 0, 0.98}, 0.02, 0.02, Tile::kPlain, paint);
  c.tube({0.34, -0.28, 1.0}, {0.34, 0.28, 1.0}, 0.015, 0.015, Tile::kPlain, rubber);
  c.box({-0.32, -0.07, 0.87}, {-0.05, 0.07, 0.92}, Tile::kPlain, 0.5, rubber);
}

void makeCrate(Carpenter& c) {
  const double size = c.random().uniform(0.35, 0.7);
  c.box({-size, -0.5 * size, 0}, {size, 0.5 * size, size}, Tile::kPlanks, 0.7, {0.36, 0.26, 0.14});
  if (c.random().uniform() < 0.6) {
    c.box({-0.4 * size, -0.4 * size, size}, {0.5 * size, 0.4 * size, 1.6 * size}, Tile::kPlanks, 0.5,
          gaudy(c.random()));
  }
}

void makeTent(Carpenter& c) {
  const Colour cloth = gaudy(c.random());
  c.panel({-1.0, -0.75, 0}, {2.0, 0, 0}, {0, 0.75, 1.15}, Tile::kPlain, 1.0, cloth);
  c.panel({1.0, 0.75, 0}, {-2.0, 0, 0}, {0, -0.75, 1.15}, Tile::kPlain, 1.0, cloth);
  c.gable({1.0, -0.75, 0}, {1.0, 0.75, 0}, {1.0, 0, 1.15}, {0.3, 0.3, 0.28});
  c.gable({-1.0, 0.75, 0}, {-1.0, -0.75, 0}, {-1.0, 0, 1.15}, {0.3, 0.3, 0.28});
}

void makeCart(Carpenter& c) {
  const Colour paint = gaudy(c.random());
  c.box({-0.8, -0.45, 0.35}, {0.8, 0.45, 0.85}, Tile::kPlanks, 0.8, paint);
  for (const double y : {-0.52, 0.52}) {
    c.ring({0.0, y, 0.32}, 0.3, 0.035, {0.03, 0.03, 0.03});
  }
  c.tube({0.8, 0, 0.5}, {1.6, 0, 0.85}, 0.025, 0.02, Tile::kPlain, {0.1, 0.1, 0.1});
}

}  // namespace

osg::ref_ptr<osg::Geometry> makeObject(const Object& object) {
  using Maker = void (*)(Carpenter&);
  static constexpr Maker kMakers[] = {makeBench, makeBin,  makeLamp, makeSign,  makeBicycle,
                                      makeCrate, makeTent, makeCart, makeTable, makeHouse};
  Carpenter carpenter(object);
  kMakers[static_cast<int>(object.kind)](carpenter);
  return carpenter.geometry();
}

}  // namespace perennial::park
