#pragma once

#include <osg/Geometry>

#include "perennial/park/conditions.h"
#include "perennial/park/park_layout.h"
#include "perennial/park/season.h"

namespace perennial::park {

/// A tree or shrub as it looks on the conditions' day. A crown is a cloud of small clusters of leaves, each
/// at a place of its own, so that it has parallax and changes shape as the robot passes. Trunk and boughs
/// stay for years; each cluster is moved elsewhere every sixty days, on a day of its own, and by the wind a
/// little every day. `ground_m`: height of the ground there.
osg::ref_ptr<osg::Geometry> makePlant(const Plant& plant, double ground_m, const Conditions& conditions,
                                      const Season& season);

}  // namespace perennial::park
