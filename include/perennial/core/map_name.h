#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace perennial {

/// A map called "garden" is the file "garden.perennial" in the map folder.
constexpr const char* kMapSuffix = ".perennial";
constexpr std::size_t kMaxMapNameLength = 100;

/// Throws MapError unless `name` is 1 to kMaxMapNameLength of A-Z a-z 0-9 _ . - and does not begin with a dot
/// or a hyphen. A name that comes from a goal cannot leave the map folder then, nor hide a file, nor look
/// like an option.
void requireMapName(const std::string& name);

/// File of a map, existing or not. Throws MapError for a name that is none.
std::string mapFile(const std::string& folder, const std::string& name);

/// The same for a map that must exist. Throws MapError that lists the maps of the folder.
std::string existingMapFile(const std::string& folder, const std::string& name);

/// Names of the maps in a folder, sorted; none when the folder does not exist. Throws MapError when it cannot
/// be read.
std::vector<std::string> listMaps(const std::string& folder);

/// Throws MapError where a new map could not be stored at `file`: it exists already (unless `overwrite`), or
/// its folder can be neither written nor created.
void requireWritableMapFile(const std::string& file, bool overwrite);

}  // namespace perennial
