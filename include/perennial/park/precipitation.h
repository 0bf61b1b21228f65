#pragma once

#include <opencv2/core.hpp>

#include "perennial/park/conditions.h"
#include "perennial/park/renderer.h"

namespace perennial::park {

/// Draws rain or snow in front of a rendered image (in place; CV_8UC4 as Renderer gives it): drops in a box
/// about the camera that fall and drift with the wind, each at a place that follows from the time alone. Does
/// nothing in dry weather. `exposure_s`: how long the drops move during the exposure. `exposure`: as given to
/// the renderer.
void drawPrecipitation(cv::Mat& rendered, const Conditions& conditions, const CameraPose& pose,
                       const CameraGeometry& geometry, double exposure_s, double exposure);

}  // namespace perennial::park
