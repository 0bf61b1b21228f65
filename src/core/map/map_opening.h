#pragma once

#include <string>

#include "core/map/sqlite.h"

namespace perennial {

/// Opens a map file and makes sure that it is one: exists, is finished, of this format version or an older
/// one, with intact header and tables. Each refusal says what is wrong and what to do. Throws MapError.
Database openMapDatabase(const std::string& file);

}  // namespace perennial
