#pragma once

#include <string>

#include "perennial/park/conditions.h"

namespace perennial::park {

/// The conditions with those changed that a YAML mapping names, such as "{date_time: '2026-06-21T20:30:00Z',
/// weather: rain}"; keys as in Conditions::load(). Throws ParameterError for an unknown key, a wrong value,
/// or text that is not a YAML mapping.
Conditions mergedConditions(const Conditions& base, const std::string& yaml);

}  // namespace perennial::park
