#pragma once

#include <geometry_msgs/Twist.h>
#include <nav_msgs/Odometry.h>
#include <ros/time.h>
#include <sensor_msgs/Image.h>

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "perennial/core/active_map.h"
#include "perennial/core/feature.h"
#include "perennial/core/map_file.h"
#include "perennial/core/map_strategy.h"
#include "perennial/core/odometer.h"
#include "perennial/core/path_profile.h"
#include "perennial/core/repeat_session.h"
#include "perennial_nav/BeginTraversalResponse.h"
#include "perennial_nav/Features.h"
#include "perennial_nav/LocalMap.h"
#include "perennial_nav/PathProfile.h"
#include "perennial_nav/Registration.h"

/// Between the core's types and messages. Numbers keep their bits in both directions. From-message
/// conversions throw Error for a message that makes no sense (arrays of different lengths, indices out of
/// range, values not finite).
namespace perennial {

perennial_nav::Features toMessage(const FeatureSet& features);
FeatureSet fromMessage(const perennial_nav::Features& message);

/// Without header, traversal and image.
perennial_nav::LocalMap toMessage(const ActiveMap& map);
ActiveMap fromMessage(const perennial_nav::LocalMap& message);

/// Without header and traversal.
perennial_nav::Registration toMessage(const NavigationStep& step);
/// What the map learns from.
Observation observationFromMessage(const perennial_nav::Registration& message);

perennial_nav::PathProfile toMessage(const PathProfile& profile);
PathProfile fromMessage(const perennial_nav::PathProfile& message);

/// Metadata as far as the navigator needs it.
MapMetadata metadataFromMessage(const perennial_nav::BeginTraversalResponse& message,
                                const std::string& name);

geometry_msgs::Twist toMessage(const Velocity& velocity);
Velocity fromMessage(const geometry_msgs::Twist& message);

/// Not checked for finite values: the Odometer does so. A quaternion of zeros gives NaN.
OdometrySample fromMessage(const nav_msgs::Odometry& message);

/// Grey image (CV_8UC1); shares the message's memory where it can, so keep the message. Throws ImageError.
cv::Mat greyImage(const sensor_msgs::ImageConstPtr& message);

}  // namespace perennial
