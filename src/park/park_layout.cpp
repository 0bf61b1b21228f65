#include "perennial/park/park_layout.h"

#include <algorithm>

#include "perennial/park/random.h"

namespace perennial::park {
namespace {

/// How many plants of which kind stand how far from the path.
struct Belt {
  PlantKind kind;
  int count;
  double minimum_m, maximum_m;  ///< from the path
  double spacing_m;             ///< to any other plant
  double height_m, radius_m;    ///< typical
  int detail;
};

constexpr Belt kBelts[] = {
    {PlantKind::kBroadleaf, 15, 3.2, 8.0, 3.0, 7.5, 2.2, 2},
    {PlantKind::kConifer, 5, 4.0, 9.0, 3.0, 8.0, 1.8, 2},
    {PlantKind::kShrub, 34, 1.9, 8.0, 1.3, 1.2, 0.8, 2},
    {PlantKind::kBroadleaf, 30, 9.0, 20.0, 3.5, 10.0, 3.0, 1},
    {PlantKind::kConifer, 10, 10.0, 20.0, 3.0, 11.0, 2.4, 1},
    {PlantKind::kShrub, 30, 8.0, 20.0, 2.0, 1.7, 1.2, 1},
    {PlantKind::kBroadleaf, 90, 22.0, 36.0, 2.6, 13.0, 3.6, 0},
    {PlantKind::kConifer, 22, 22.0, 36.0, 2.6, 14.0, 3.0, 0},
};

/// Middle of the loop, about which the park is laid out.
Pose centre(const LoopPath& path) {
  Pose sum;
  constexpr int kSamples = 64;
  for (int i = 0; i < kSamples; ++i) {
    const Pose pose = path.at(path.length() * i / kSamples);
    sum.x += pose.x / kSamples;
    sum.y += pose.y / kSamples;
  }
  return sum;
}

/// A place beside the path; left positive.
Pose beside(const LoopPath& path, double share, double left_m, double turn) {
  const Pose pose = path.at(share * path.length());
  return {pose.x - left_m * std::sin(pose.heading), pose.y + left_m * std::cos(pose.heading),
          pose.heading + turn};
}

double distanceTo(const Pose& pose, double x, double y) { return std::hypot(pose.x - x, pose.y - y); }

class Planner {
 public:
  Planner(const LoopPath& path, int seed) : path_(path), centre_(centre(path)), random_(mix({seed, 1})) {}

  ParkLayout plan() {
    putFurniture();
    putSpots();
    for (const Belt& belt : kBelts) {
      plant(belt);
    }
    return layout_;
  }

 private:
  void put(ObjectKind kind, const Pose& pose) {
    layout_.furniture.push_back({kind, pose, static_cast<std::int64_t>(random_.next() >> 1U)});
  }

  void putFurniture() {
    constexpr double kQuarter = 3.14159265358979323846 / 2.0;
    put(ObjectKind::kHouse, beside(path_, 0.33, -7.5, 0.1));
    for (const double share : {0.05, 0.42, 0.78}) {
      put(ObjectKind::kBench, beside(path_, share + random_.uniform(-0.02, 0.02), -2.1, kQuarter));
      put(ObjectKind::kBin, beside(path_, share + 0.045, -2.0, 0.0));
    }
    for (const double share : {0.12, 0.37, 0.6, 0.87}) {
      put(ObjectKind::kLamp, beside(path_, share, share < 0.5 ? -2.4 : 2.3, 0.0));
    }
    put(ObjectKind::kSign, beside(path_, 0.22, 1.7, kQuarter * 2.0));
    put(ObjectKind::kPicnicTable, beside(path_, 0.7, -5.0, 0.4));
  }

  void putSpots() {
    constexpr int kSpots = 14;
    for (int i = 0; i < kSpots; ++i) {
      const double side = random_.uniform() < 0.65 ? -1.0 : 1.0;
      const Pose spot = beside(path_, (i + random_.uniform(0.1, 0.9)) / kSpots,
                               side * random_.uniform(2.2, 6.5), random_.uniform(-3.1, 3.1));
      // Inside the bend of the loop, a place beside one part of the path may lie on another.
      const bool on_furniture =
          std::any_of(layout_.furniture.begin(), layout_.furniture.end(), [&](const Object& object) {
            return distanceTo(object.pose, spot.x, spot.y) < (object.kind == ObjectKind::kHouse ? 4.0 : 1.5);
          });
      if (std::abs(path_.nearest(spot.x, spot.y).lateral_m) > 2.0 && !on_furniture) {
        layout_.spots.push_back(spot);
      }
    }
  }

  void plant(const Belt& belt) {
    constexpr int kTriesPerPlant = 60;
    int planted = 0;
    for (int i = 0; i < belt.count * kTriesPerPlant && planted < belt.count; ++i) {
      const double radius = 6.0 + belt.maximum_m;
      const double angle = random_.uniform(0.0, 6.28318530717958648);
      const double distance = radius * std::sqrt(random_.uniform());
      const double x = centre_.x + distance * std::cos(angle);
      const double y = centre_.y + distance * std::sin(angle);
      if (isFree(x, y, belt)) {
        const double size = random_.uniform(0.75, 1.25);
        layout_.plants.push_back({belt.kind, x, y, belt.height_m * size,
                                  belt.radius_m * random_.uniform(0.8, 1.2), belt.detail,
                                  static_cast<std::int64_t>(random_.next() >> 1U)});
        ++planted;
      }
    }
  }

  bool isFree(double x, double y, const Belt& belt) const {
    const double from_path = std::abs(path_.nearest(x, y).lateral_m);
    const bool beside_path = from_path >= belt.minimum_m && from_path <= belt.maximum_m;
    return beside_path &&
           std::none_of(
               layout_.plants.begin(), layout_.plants.end(),
               [&](const Plant& other) { return std::hypot(other.x - x, other.y - y) < belt.spacing_m; }) &&
           std::none_of(layout_.spots.begin(), layout_.spots.end(),
                        [&](const Pose& spot) { return distanceTo(spot, x, y) < 1.2; }) &&
           std::none_of(layout_.furniture.begin(), layout_.furniture.end(), [&](const Object& object) {
             return distanceTo(object.pose, x, y) < (object.kind == ObjectKind::kHouse ? 5.5 : 1.3);
           });
  }

  const LoopPath& path_;
  Pose centre_;
  Random random_;
  ParkLayout layout_;
};

}  // namespace

ParkLayout makeLayout(const LoopPath& path, int seed) { return Planner(path, seed).plan(); }

std::vector<Object> thingsOfDay(const ParkLayout& layout, int seed, std::int64_t day) {
  static const ObjectKind kKinds[] = {ObjectKind::kBicycle, ObjectKind::kCrate, ObjectKind::kTent,
                                      ObjectKind::kCart};
  std::vector<Object> things;
  for (std::size_t i = 0; i < layout.spots.size(); ++i) {
    const auto spot = static_cast<std::int64_t>(i);
    Random place(mix({seed, spot, 5}));
    const std::int64_t period = 1 + place.below(10);
    const std::int64_t epoch = (day + place.below(10)) / period;
    Random random(mix({seed, spot, epoch, 6}));
    if (random.uniform() < 0.45) {
      Pose pose = layout.spots[i];
      pose.heading += random.uniform(-1.5, 1.5);
      things.push_back({kKinds[random.below(4)], pose, static_cast<std::int64_t>(random.next() >> 1U)});
    }
  }
  return things;
}

}  // namespace perennial::park
