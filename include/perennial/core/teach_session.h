#pragma once

#include <cstddef>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "perennial/core/feature_extractor.h"
#include "perennial/core/map_file.h"
#include "perennial/core/parameter_reader.h"
#include "perennial/core/path_profile.h"

namespace perennial {

struct TeachSettings {
  double map_interval_m = 0.2;  ///< a local map is made every so far
  /// Where the velocity profile comes from: "commands", "odometry", or "auto": the commands if any of them
  /// drove.
  std::string velocity_source = "auto";
  double velocity_step = 0.02;  ///< odometry's velocities are recorded in steps of this, m/s and rad/s

  /// Keys as the members are called. Throws ParameterError.
  static TeachSettings load(ParameterReader& reader);
};

/// What was taught.
struct TeachSummary {
  std::string file;
  double distance_m = 0.0;
  std::size_t local_maps = 0;
  std::size_t features = 0;  ///< of all local maps
};

/// Records a path: images become local maps, velocities the path profile. Distances are those of the
/// odometer; the first image is where the path begins, at distance 0. Not thread-safe.
///
/// Throws MapError (the map exists already, the folder cannot be written, the disk is full) and ImageError
/// (an image that differs from the first in size or encoding); after an ImageError the session goes on with
/// the next image.
class TeachSession {
 public:
  /// Fails early where a map at `file` could not be stored in the end. `metadata`: name and camera; the rest
  /// is filled in from the images.
  TeachSession(const std::string& file, const MapMetadata& metadata, bool overwrite,
               const TeachSettings& settings, const ExtractionSettings& extraction);
  ~TeachSession();

  /// The camera's name, where it is known from the images only; no effect after the first image.
  void nameCamera(const std::string& name) { metadata_.camera = name; }

  /// A velocity commanded to the robot when it had travelled this far.
  void addCommand(double travelled_m, const Velocity& velocity);
  /// A velocity measured by the odometry.
  void addMeasuredVelocity(double travelled_m, const Velocity& velocity);

  /// `image`: CV_8UC1; `encoding`: of the image as the camera sent it. True when it became a local map.
  bool addImage(double stamp_s, double travelled_m, const cv::Mat& image, const std::string& encoding);

  /// Stores the map. Throws MapError when there is nothing to repeat: no image, or no distance travelled.
  TeachSummary finish(double travelled_m);

  double distance(double travelled_m) const;  ///< along the path, 0 before the first image
  std::size_t localMaps() const { return local_maps_; }
  std::size_t newestFeatures() const { return newest_features_; }

 private:
  void begin(double stamp_s, double travelled_m, const cv::Mat& image, const std::string& encoding);
  void requireSameImage(const cv::Mat& image, const std::string& encoding) const;
  const PathProfile& chosenProfile() const;

  std::string file_;
  MapMetadata metadata_;
  bool overwrite_;
  TeachSettings settings_;
  FeatureExtractor extractor_;
  std::unique_ptr<MapWriter> writer_;

  std::optional<double> start_m_;  ///< travelled distance at the first image
  double next_map_m_ = 0.0;
  std::size_t local_maps_ = 0;
  std::size_t newest_features_ = 0;
  std::size_t all_features_ = 0;
  PathProfile commanded_;
  PathProfile measured_;
};

}  // namespace perennial
