#pragma once

#include <osg/Program>

namespace perennial::park {

/// Programs that draw the park. All work in the park's coordinates (vertices have no transform) and write the
/// square root of (radiance * exposure / kWhiteLevel): eight bits then resolve dark places about as a camera
/// does. Red, green and blue go to the first three channels, brightness to the fourth; nothing is blended.
constexpr double kWhiteLevel =
    2.0;  ///< light that fits into a pixel of the rendered image; 1 saturates the camera

osg::ref_ptr<osg::Program> objectProgram();
osg::ref_ptr<osg::Program> groundProgram();
osg::ref_ptr<osg::Program> skyProgram();
/// Draws depth only, for the shadow map.
osg::ref_ptr<osg::Program> shadowProgram();

}  // namespace perennial::park
