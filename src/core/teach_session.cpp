#include "perennial/core/teach_session.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "perennial/core/error.h"
#include "perennial/core/map_name.h"

namespace perennial {
namespace {

/// Sums of steps that meet the interval exactly may fall short of it by rounding.
constexpr double kRounding_m = 1e-6;

double inSteps(double value, double step) { return step > 0.0 ? std::round(value / step) * step : value; }

std::string imageKind(int width, int height, const std::string& encoding) {
  return std::to_string(width) + "x" + std::to_string(height) + " " + encoding;
}

bool travels(const PathProfile& profile) {
  return std::any_of(profile.entries().begin(), profile.entries().end(),
                     [](const ProfileEntry& entry) { return entry.velocity.forward != 0.0; });
}

}  // namespace

TeachSettings TeachSettings::load(ParameterReader& reader) {
  TeachSettings settings;
  settings.map_interval_m = reader.real("map_interval_m", settings.map_interval_m, 0.01, 100.0);
  settings.velocity_source =
      reader.choice("velocity_source", settings.velocity_source, {"auto", "commands", "odometry"});
  settings.velocity_step = reader.real("velocity_step", settings.velocity_step, 0.0, 1.0);
  return settings;
}

TeachSession::TeachSession(const std::string& file, const MapMetadata& metadata, bool overwrite,
                           const TeachSettings& settings, const ExtractionSettings& extraction)
    : file_(file), metadata_(metadata), overwrite_(overwrite), settings_(settings), extractor_(extraction) {
  metadata_.extraction = extraction.describe();
  metadata_.map_interval_m = settings.map_interval_m;
  requireWritableMapFile(file, overwrite);
}

TeachSession::~TeachSession() = default;

double TeachSession::distance(double travelled_m) const {
  return start_m_ ? std::max(0.0, travelled_m - *start_m_) : 0.0;
}

void TeachSession::addCommand(double travelled_m, const Velocity& velocity) {
  commanded_.add(distance(travelled_m), velocity);
}

void TeachSession::addMeasuredVelocity(double travelled_m, const Velocity& velocity) {
  Velocity rounded = velocity;
  rounded.forward = inSteps(velocity.forward, settings_.velocity_step);
  rounded.angular = inSteps(velocity.angular, settings_.velocity_step);
  measured_.add(distance(travelled_m), rounded);
}

bool TeachSession::addImage(double stamp_s, double travelled_m, const cv::Mat& image,
                            const std::string& encoding) {
  if (!start_m_) {
    begin(stamp_s, travelled_m, image, encoding);
  }
  requireSameImage(image, encoding);
  const double distance_m = distance(travelled_m);
  if (distance_m < next_map_m_ - kRounding_m) {
    return false;
  }
  LocalMap map;
  map.index = static_cast<std::uint32_t>(local_maps_);
  map.distance_m = distance_m;
  map.stamp_s = stamp_s;
  const FeatureSet features = extractor_.extract(image);
  for (std::size_t i = 0; i < features.size(); ++i) {
    map.add(features.keypoints[i], features.descriptors[i]);
  }
  writer_->add(map, image);
  ++local_maps_;
  newest_features_ = features.size();
  all_features_ += features.size();
  // On a grid, so that the interval is kept on average although images come when they come.
  next_map_m_ =
      (std::floor((distance_m + kRounding_m) / settings_.map_interval_m) + 1.0) * settings_.map_interval_m;
  return true;
}

void TeachSession::begin(double stamp_s, double travelled_m, const cv::Mat& image,
                         const std::string& encoding) {
  metadata_.image_width = image.cols;
  metadata_.image_height = image.rows;
  metadata_.image_encoding = encoding;
  metadata_.taught_stamp_s = stamp_s;
  writer_ = std::make_unique<MapWriter>(file_, metadata_, overwrite_);
  start_m_ = travelled_m;
}

void TeachSession::requireSameImage(const cv::Mat& image, const std::string& encoding) const {
  if (image.cols != metadata_.image_width || image.rows != metadata_.image_height ||
      encoding != metadata_.image_encoding) {
    throw ImageError("an image of " + imageKind(image.cols, image.rows, encoding) + ", but map '" +
                     metadata_.name + "' is being taught with " +
                     imageKind(metadata_.image_width, metadata_.image_height, metadata_.image_encoding) +
                     "; keep the camera's settings while teaching");
  }
}

const PathProfile& TeachSession::chosenProfile() const {
  const bool commands =
      settings_.velocity_source == "commands" || (settings_.velocity_source == "auto" && travels(commanded_));
  return commands ? commanded_ : measured_;
}

TeachSummary TeachSession::finish(double travelled_m) {
  const double length_m = distance(travelled_m);
  if (local_maps_ == 0) {
    throw MapError("map '" + metadata_.name +
                   "' has no local map: no image came together with odometry; "
                   "check the image and odometry topics");
  }
  if (length_m <= 0.0) {
    throw MapError("map '" + metadata_.name +
                   "' has length 0: the odometry did not move while teaching; "
                   "check the odometry topic");
  }
  const PathProfile& profile = chosenProfile();
  if (!travels(profile)) {
    throw MapError("map '" + metadata_.name +
                   "' has no velocities: neither commands nor odometry told how fast to "
                   "drive; check the command topic and the parameter velocity_source");
  }
  writer_->finish(profile, length_m);
  TeachSummary summary;
  summary.file = file_;
  summary.distance_m = length_m;
  summary.local_maps = local_maps_;
  summary.features = all_features_;
  return summary;
}

}  // namespace perennial
