#pragma once

#include <opencv2/core.hpp>

#include "perennial/core/feature.h"
#include "perennial/core/registration.h"

namespace perennial {

/// A picture of a registration for people: the map's image left, the view right, pairs that agree with the
/// displacement green, others red, and the histogram of votes below. Images CV_8UC1 of any sizes; an empty
/// one is drawn grey, in the size of the other. Returns CV_8UC3 (BGR).
cv::Mat drawMatches(const cv::Mat& map_image, const cv::Mat& view_image, const FeatureSet& map,
                    const FeatureSet& view, const RegistrationResult& result);

}  // namespace perennial
