#include "perennial/ros/conversions.h"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>

#include "perennial/core/error.h"

namespace perennial {
namespace {

/// No camera has more pixels in a row; coordinates beyond are a broken message.
constexpr float kLargestCoordinate_px = 1e5F;

bool plausible(float coordinate) { return std::abs(coordinate) <= kLargestCoordinate_px; }

void require(bool condition, const char* what) {
  if (!condition) {
    throw Error(std::string("a message is broken: ") + what);
  }
}

/// All alternatives of a local map have the same: those of the taught image.
void putEdges(const EdgeField& edges, perennial_nav::LocalMap& message) {
  message.edge_cell_px = static_cast<std::uint16_t>(edges.cell_px);
  message.edge_columns = static_cast<std::uint16_t>(edges.columns);
  message.edge_rows = static_cast<std::uint16_t>(edges.rows);
  message.edges = edges.values;
}

EdgeField edgesOf(const perennial_nav::LocalMap& message) {
  EdgeField edges;
  edges.cell_px = message.edge_cell_px;
  edges.columns = message.edge_columns;
  edges.rows = message.edge_rows;
  edges.values = message.edges;
  require(edges.sound(), "the edges of a local map do not add up");
  return edges;
}

}  // namespace

perennial_nav::Features toMessage(const FeatureSet& features) {
  perennial_nav::Features message;
  for (auto* values : {&message.x, &message.y, &message.scale, &message.response}) {
    values->reserve(features.size());
  }
  for (const Keypoint& keypoint : features.keypoints) {
    message.x.push_back(keypoint.x);
    message.y.push_back(keypoint.y);
    message.scale.push_back(keypoint.scale);
    message.response.push_back(keypoint.response);
  }
  message.descriptors.resize(features.size() * Descriptor::kBytes);
  for (std::size_t i = 0; i < features.size(); ++i) {
    std::memcpy(&message.descriptors[i * Descriptor::kBytes], features.descriptors[i].words.data(),
                Descriptor::kBytes);
  }
  return message;
}

FeatureSet fromMessage(const perennial_nav::Features& message) {
  const std::size_t n = message.x.size();
  require(message.y.size() == n && message.scale.size() == n && message.response.size() == n &&
              message.descriptors.size() == n * Descriptor::kBytes,
          "the arrays of its features differ in length");
  FeatureSet features;
  features.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    require(plausible(message.x[i]) && plausible(message.y[i]), "a feature lies outside of any image");
    Descriptor descriptor;
    std::memcpy(descriptor.words.data(), &message.descriptors[i * Descriptor::kBytes], Descriptor::kBytes);
    features.add({message.x[i], message.y[i], message.scale[i], message.response[i]}, descriptor);
  }
  return features;
}

perennial_nav::LocalMap toMessage(const ActiveMap& map) {
  perennial_nav::LocalMap message;
  message.index = map.index;
  message.distance_m = map.distance_m;
  FeatureSet all;
  all.reserve(map.alternatives.empty() ? 0
                                       : map.alternatives.size() * map.alternatives.front().features.size());
  for (const ActiveMap::Alternative& alternative : map.alternatives) {
    for (std::size_t i = 0; i < alternative.features.size(); ++i) {
      all.add(alternative.features.keypoints[i], alternative.features.descriptors[i]);
    }
    message.alternative_sizes.push_back(static_cast<std::uint32_t>(alternative.features.size()));
    message.positions.insert(message.positions.end(), alternative.positions.begin(),
                             alternative.positions.end());
  }
  message.features = toMessage(all);
  if (!map.alternatives.empty()) {
    putEdges(map.alternatives.front().features.edges, message);
  }
  return message;
}

ActiveMap fromMessage(const perennial_nav::LocalMap& message) {
  const FeatureSet all = fromMessage(message.features);
  std::size_t total = 0;
  for (const std::uint32_t size : message.alternative_sizes) {
    total += size;
  }
  require(!message.alternative_sizes.empty() && total == all.size() && message.positions.size() == all.size(),
          "the alternatives of a local map do not add up");
  require(std::isfinite(message.distance_m), "the distance of a local map is not finite");
  ActiveMap map;
  map.index = message.index;
  map.distance_m = message.distance_m;
  const EdgeField edges = edgesOf(message);
  std::size_t next = 0;
  for (const std::uint32_t size : message.alternative_sizes) {
    ActiveMap::Alternative alternative;
    alternative.features.edges = edges;
    alternative.features.reserve(size);
    alternative.positions.reserve(size);
    for (const std::size_t end = next + size; next < end; ++next) {
      alternative.features.add(all.keypoints[next], all.descriptors[next]);
      alternative.positions.push_back(message.positions[next]);
    }
    map.alternatives.push_back(std::move(alternative));
  }
  return map;
}

perennial_nav::Registration toMessage(const NavigationStep& step) {
  const RegistrationResult& result = step.registration.result;
  perennial_nav::Registration message;
  message.local_map = step.local_map;
  message.local_map_distance_m = step.local_map_distance_m;
  message.distance_m = step.distance_m;
  message.has_displacement = result.displacement_px.has_value();
  message.displacement_px = result.displacement_px.value_or(0.0);
  message.confidence = result.confidence;
  message.uncertainty_px = result.uncertainty_px;
  message.inliers = result.inliers;
  message.matches = result.matches;
  message.bin_width_px = result.histogram.bin_width_px;
  message.histogram.assign(result.histogram.counts.begin(), result.histogram.counts.end());
  message.alternative = static_cast<std::uint32_t>(step.registration.alternative);
  message.positions = step.positions;
  for (const FeatureState state : result.states) {
    message.states.push_back(static_cast<std::uint8_t>(state));
  }
  message.partners = result.partners;
  message.view = toMessage(step.view);
  return message;
}

Observation observationFromMessage(const perennial_nav::Registration& message) {
  const std::size_t n = message.positions.size();
  require(message.states.size() == n && message.partners.size() == n,
          "the arrays of a registration differ in length");
  require(std::isfinite(message.displacement_px) && std::isfinite(message.distance_m) &&
              std::isfinite(message.confidence) && std::isfinite(message.uncertainty_px),
          "a registration holds a value that is not finite");
  Observation observation;
  observation.view = fromMessage(message.view);
  observation.used.assign(message.positions.begin(), message.positions.end());
  observation.stamp_s = message.header.stamp.toSec();
  observation.distance_m = message.distance_m;
  RegistrationResult& result = observation.registration;
  if (message.has_displacement) {
    result.displacement_px = message.displacement_px;
  }
  result.confidence = message.confidence;
  result.uncertainty_px = message.uncertainty_px;
  result.inliers = message.inliers;
  result.matches = message.matches;
  result.histogram.bin_width_px = message.bin_width_px;
  result.histogram.counts.assign(message.histogram.begin(), message.histogram.end());
  result.partners = message.partners;
  for (std::size_t i = 0; i < n; ++i) {
    require(message.states[i] <= perennial_nav::Registration::MATCHED_INCORRECTLY,
            "a feature's state is unknown");
    require(message.partners[i] < static_cast<std::int32_t>(observation.view.size()),
            "a feature's partner is not in the view");
    result.states.push_back(static_cast<FeatureState>(message.states[i]));
  }
  return observation;
}

perennial_nav::PathProfile toMessage(const PathProfile& profile) {
  perennial_nav::PathProfile message;
  for (const ProfileEntry& entry : profile.entries()) {
    message.distance_m.push_back(entry.distance_m);
    message.forward.push_back(entry.velocity.forward);
    message.angular.push_back(entry.velocity.angular);
    message.flipper.push_back(entry.velocity.flipper);
  }
  return message;
}

PathProfile fromMessage(const perennial_nav::PathProfile& message) {
  const std::size_t n = message.distance_m.size();
  require(message.forward.size() == n && message.angular.size() == n && message.flipper.size() == n,
          "the arrays of a path profile differ in length");
  std::vector<ProfileEntry> entries;
  for (std::size_t i = 0; i < n; ++i) {
    entries.push_back({message.distance_m[i], {message.forward[i], message.angular[i], message.flipper[i]}});
  }
  return PathProfile::fromEntries(std::move(entries));
}

MapMetadata metadataFromMessage(const perennial_nav::BeginTraversalResponse& message,
                                const std::string& name) {
  MapMetadata metadata;
  metadata.name = name;
  metadata.camera = message.camera;
  metadata.image_width = static_cast<int>(message.image_width);
  metadata.image_height = static_cast<int>(message.image_height);
  metadata.image_encoding = message.image_encoding;
  metadata.extraction = message.extraction;
  metadata.map_interval_m = message.map_interval_m;
  metadata.length_m = message.length_m;
  return metadata;
}

geometry_msgs::Twist toMessage(const Velocity& velocity) {
  geometry_msgs::Twist message;
  message.linear.x = velocity.forward;
  message.angular.z = velocity.angular;
  message.angular.y = velocity.flipper;
  return message;
}

Velocity fromMessage(const geometry_msgs::Twist& message) {
  return {message.linear.x, message.angular.z, message.angular.y};
}

OdometrySample fromMessage(const nav_msgs::Odometry& message) {
  const auto& q = message.pose.pose.orientation;
  const double norm = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  OdometrySample sample;
  sample.stamp_s = message.header.stamp.toSec();
  sample.x_m = norm > 0.0 ? message.pose.pose.position.x : std::numeric_limits<double>::quiet_NaN();
  sample.y_m = message.pose.pose.position.y;
  sample.forward_m_s = message.twist.twist.linear.x;
  sample.angular_rad_s = message.twist.twist.angular.z;
  return sample;
}

cv::Mat greyImage(const sensor_msgs::ImageConstPtr& message) {
  try {
    return cv_bridge::toCvShare(message, sensor_msgs::image_encodings::MONO8)->image;
  } catch (const std::exception& error) {
    throw ImageError("an image of " + std::to_string(message->width) + "x" + std::to_string(message->height) +
                     " " + message->encoding + " cannot be read as a grey image: " + error.what());
  }
}

}  // namespace perennial
