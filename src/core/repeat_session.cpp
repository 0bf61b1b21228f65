#include "perennial/core/repeat_session.h"

#include <algorithm>
#include <utility>

#include "perennial/core/error.h"

namespace perennial {
namespace {

/// Local maps this far behind the robot are no longer needed.
constexpr double kKeepBehind_m = 2.0;
/// A gap between images longer than twice this is a pause, not a rhythm.
constexpr double kLongestPreview_m = 0.5;

}  // namespace

RepeatSession::RepeatSession(const MapMetadata& map, const PathProfile& profile, std::size_t local_maps,
                             const RepeatSettings& settings)
    : map_(map),
      profile_(profile),
      local_maps_(local_maps),
      length_m_(map.length_m),
      extractor_(settings.extraction),
      registration_(makeRegistration(settings.registration)),
      steering_(settings.steering),
      along_path_(settings.along_path) {
  requireSameExtraction(map, settings.extraction.describe());
}

void RepeatSession::beginTraversal(double start_m, std::optional<double> travelled_m) {
  start_m_ = start_m;
  start_travelled_m_ = travelled_m;
  along_path_.reset();
  window_.reset(local_maps_);
}

void RepeatSession::requireSuitable(const cv::Mat& image, const std::string& encoding) const {
  if (image.cols == map_.image_width && image.rows == map_.image_height && encoding == map_.image_encoding) {
    return;
  }
  const auto kind = [](int width, int height, const std::string& name) {
    return std::to_string(width) + "x" + std::to_string(height) + " " + name;
  };
  throw ImageError("an image of " + kind(image.cols, image.rows, encoding) + ", but map '" + map_.name +
                   "' was taught with " + kind(map_.image_width, map_.image_height, map_.image_encoding) +
                   "; set the camera as it was when teaching");
}

NavigationStep RepeatSession::step(double stamp_s, double travelled_m, const cv::Mat& image) {
  NavigationStep step;
  stepInto(stamp_s, travelled_m, image, step);
  correctAlongPath(step);
  return step;
}

void RepeatSession::stepInto(double stamp_s, double travelled_m, const cv::Mat& image, NavigationStep& step) {
  if (!start_travelled_m_) {
    start_travelled_m_ = travelled_m;
  }
  step.interval_m = previous_travelled_m_ ? travelled_m - *previous_travelled_m_ : 0.0;
  previous_travelled_m_ = travelled_m;
  step.stamp_s = stamp_s;
  step.distance_m = distance(travelled_m);
  const ActiveMap* map = window_.nearest(step.distance_m);
  if (map == nullptr) {
    throw Error("no local map of '" + map_.name + "' at " + std::to_string(step.distance_m) + " m");
  }
  step.local_map = map->index;
  step.local_map_distance_m = map->distance_m;
  extractor_.extractInto(image, step.view);
  registerInto(*registration_, *map, step.view, workspace_, step.registration);
  step.positions = map->alternatives[step.registration.alternative].positions;
  step.velocity = velocityFor(step);
  window_.forgetBefore(step.distance_m, kKeepBehind_m);
}

PlaceEvidence RepeatSession::evidence(const ActiveMap& map, const FeatureSet& view) {
  registerInto(*registration_, map, view, workspace_, neighbour_);
  return {map.distance_m, neighbour_.result.inliers};
}

void RepeatSession::correctAlongPath(const NavigationStep& step) {
  if (!along_path_.enabled() || !step.registration.result.displacement_px || step.local_map == 0) {
    return;
  }
  const ActiveMap* before = window_.find(step.local_map - 1);
  const ActiveMap* after = window_.find(step.local_map + 1);
  if (before == nullptr || after == nullptr) {
    return;
  }
  const auto seen_m =
      placeOfView(evidence(*before, step.view), {step.local_map_distance_m, step.registration.result.inliers},
                  evidence(*after, step.view));
  if (seen_m) {
    along_path_.update(step.distance_m, *seen_m, step.interval_m);
  }
}

Velocity RepeatSession::velocityFor(const NavigationStep& step) const {
  // The command holds until the next image: the velocity taught half an image's way ahead is its best mean.
  // Looked up at the image itself, every curve would be entered that much too late.
  const double preview_m = std::clamp(step.interval_m / 2.0, 0.0, kLongestPreview_m);
  return steer(profile_.travellingAt(step.distance_m + preview_m), step.registration.result.displacement_px,
               focal_length_px_, steering_);
}

Observation observationOf(const NavigationStep& step) {
  Observation observation;
  observation.view = step.view;
  observation.registration = step.registration.result;
  observation.used.assign(step.positions.begin(), step.positions.end());
  observation.stamp_s = step.stamp_s;
  observation.distance_m = step.distance_m;
  return observation;
}

}  // namespace perennial
