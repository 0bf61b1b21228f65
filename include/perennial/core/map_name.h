#pragma once

#include <string>
#include <vector>

namespace perennial {

/// File of a map by its name: `<folder>/<name>.perennial`. A name is a plain word of letters, digits, '_', '-' and '.',
/// not starting with '.', at most 100 characters, so that no name from a goal leaves the folder. Throws MapError.
std::string mapFile(const std::string& folder, const std::string& name);

/// As mapFile(), for a map that must exist: the error lists those that do.
std::string existingMapFile(const std::string& folder, const std::string& name);

/// Names of the maps in a folder, sorted; none for a folder that does not exist.
std::vector<std::string> listMaps(const std::string& folder);

/// Throws MapError where a new map could not be stored at `file`: it exists already (unless `overwrite`), or its folder
/// can be neither written nor created.
void requireWritableMapFile(const std::string& file, bool overwrite);

}  // namespace perennial
