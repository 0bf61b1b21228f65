#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "perennial/core/active_map.h"
#include "perennial/core/along_path.h"
#include "perennial/core/feature_extractor.h"
#include "perennial/core/map_file.h"
#include "perennial/core/map_strategy.h"
#include "perennial/core/path_profile.h"
#include "perennial/core/registration.h"
#include "perennial/core/steering.h"

namespace perennial {

struct RepeatSettings {
  ExtractionSettings extraction;
  RegistrationSettings registration;
  SteeringSettings steering;
  AlongPathSettings along_path;
};

/// What came of one image.
struct NavigationStep {
  double stamp_s = 0.0;
  double distance_m = 0.0;      ///< along the path, as assumed before the image was seen
  double interval_m = 0.0;      ///< travelled since the image before
  std::uint32_t local_map = 0;  ///< index of the local map registered against
  double local_map_distance_m = 0.0;
  std::vector<std::uint32_t> positions;  ///< of the features registered: position in the stored local map
  ActiveRegistration registration;
  FeatureSet view;
  Velocity velocity;  ///< to send to the robot, at the taught speed
};

/// Follows a taught path: from an image and the travelled distance to a velocity. What the repeat navigator
/// runs, and the same without ROS. Local maps are pushed in ahead of time. Not thread-safe.
class RepeatSession {
 public:
  /// Throws MapError when the map was taught with other extraction settings.
  RepeatSession(const MapMetadata& map, const PathProfile& profile, std::size_t local_maps,
                const RepeatSettings& settings);

  /// A traversal begins at `start_m` of the path, where the robot stands having travelled `travelled_m` in
  /// all; without that, where it stands when the first image is taken.
  void beginTraversal(double start_m, std::optional<double> travelled_m = std::nullopt);

  /// Place along the path; may lie beyond its end, which is the overshoot to begin the next traversal with.
  double distance(double travelled_m) const {
    return start_m_ + travelled_m - start_travelled_m_.value_or(travelled_m) + along_path_.correction();
  }
  bool atEnd(double travelled_m) const { return distance(travelled_m) >= length_m_; }
  double length() const { return length_m_; }

  /// The robot's place along the path changes by this; for what the odometer does not know, as a person
  /// driving it back.
  void shift(double distance_m) { start_m_ += distance_m; }

  void add(ActiveMap map) { window_.add(std::move(map)); }
  /// Whether the local map for this place has come.
  bool ready(double travelled_m) const { return window_.nearest(distance(travelled_m)) != nullptr; }

  /// Index of the first local map held, when a robot that was backed stands before it: those in front of it
  /// are to be added again, from the last to the first.
  std::optional<std::uint32_t> backedBefore(double travelled_m) const {
    return window_.firstBeyond(distance(travelled_m));
  }

  /// Throws ImageError when an image differs in size or encoding from those the map was taught with.
  void requireSuitable(const cv::Mat& image, const std::string& encoding) const;

  /// Features as the map has them. `image`: as requireSuitable() wants it, CV_8UC1.
  void extractInto(const cv::Mat& image, FeatureSet& view) { extractor_.extractInto(image, view); }

  /// Registers the image, steers, and corrects the distance. `image`: CV_8UC1. Must be ready().
  NavigationStep step(double stamp_s, double travelled_m, const cv::Mat& image);
  /// Registers the image and steers, into a step whose memory is used again: once it has served for as many
  /// features, nothing is allocated. The distance is left to correctAlongPath(), so that the velocity need
  /// not wait for it.
  void stepInto(double stamp_s, double travelled_m, const cv::Mat& image, NavigationStep& step);
  /// Corrects the distance by what the newest step's view says, for the images that follow.
  void correctAlongPath(const NavigationStep& step);

  /// Steering and registration may change on the way; a camera's focal length may become known.
  void setSteering(const SteeringSettings& steering) { steering_ = steering; }
  void setRegistration(const RegistrationSettings& settings) { registration_ = makeRegistration(settings); }
  void setFocalLength(std::optional<double> focal_length_px) { focal_length_px_ = focal_length_px; }

 private:
  PlaceEvidence evidence(const ActiveMap& map, const FeatureSet& view);
  /// Velocity to send until the next image.
  Velocity velocityFor(const NavigationStep& step) const;

  MapMetadata map_;
  PathProfile profile_;
  std::size_t local_maps_;
  double length_m_;
  FeatureExtractor extractor_;
  std::unique_ptr<Registration> registration_;
  SteeringSettings steering_;
  AlongPathCorrection along_path_;
  std::optional<double> focal_length_px_;

  ActiveMapWindow window_;
  ActiveRegistrationWorkspace workspace_;
  ActiveRegistration neighbour_;  ///< of the local map before or after the robot's
  double start_m_ = 0.0;
  std::optional<double> start_travelled_m_;
  std::optional<double> previous_travelled_m_;
};

/// The part of a step that the map learns from.
Observation observationOf(const NavigationStep& step);

}  // namespace perennial
