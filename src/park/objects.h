#pragma once

#include <osg/Geometry>

#include "perennial/park/park_layout.h"

namespace perennial::park {

/// A bench, the house, a crate that somebody left: everything that people have made.
osg::ref_ptr<osg::Geometry> makeObject(const Object& object);

}  // namespace perennial::park
