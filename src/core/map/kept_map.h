#pragma once

#include <string>

#include "core/map/sqlite.h"

namespace perennial {

/// Gives the map file that `source` has open a second name, beside the first; where the file system has no
/// hard links, copies it. Returns false when there is a file of that name already, with the same content: an
/// earlier attempt was interrupted. Throws MapError when that file holds anything else; it is not touched.
bool keepMapAs(const Database& source, const std::string& kept);

}  // namespace perennial
