#include "perennial/core/map_name.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "perennial/core/error.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

constexpr char kSuffix[] = ".perennial";
constexpr std::size_t kLongestName = 100;
constexpr char kAllowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";

/// The folder itself or, while it does not exist, the nearest one above it that does.
fs::path nearestExisting(fs::path folder) {
  std::error_code ignored;
  while (!fs::exists(folder, ignored) && folder.has_parent_path() && folder != folder.parent_path()) {
    folder = folder.parent_path();
  }
  return folder;
}

}  // namespace

std::string mapFile(const std::string& folder, const std::string& name) {
  const bool valid = !name.empty() && name.size() <= kLongestName && name.front() != '.' &&
                     name.find_first_not_of(kAllowed) == std::string::npos;
  if (!valid) {
    throw MapError("'" + name + "' cannot be the name of a map: use letters, digits, '_', '-' and '.', at most " +
                   std::to_string(kLongestName) + " of them, and do not begin with '.'");
  }
  return (fs::path(folder) / (name + kSuffix)).string();
}

std::string existingMapFile(const std::string& folder, const std::string& name) {
  std::string file = mapFile(folder, name);
  std::error_code ignored;
  if (!fs::exists(file, ignored)) {
    std::string known;
    for (const std::string& other : listMaps(folder)) {
      known += (known.empty() ? "" : ", ") + other;
    }
    throw MapError("there is no map '" + name + "' in " + folder + "; the maps there are: " +
                   (known.empty() ? "none" : known));
  }
  return file;
}

std::vector<std::string> listMaps(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().extension() == kSuffix) {
      names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

void requireWritableMapFile(const std::string& file, bool overwrite) {
  std::error_code ignored;
  if (fs::exists(file, ignored) && !overwrite) {
    throw MapError(file + " exists already; choose another name, or say overwrite to replace it");
  }
  const fs::path folder = nearestExisting(fs::absolute(fs::path(file)).parent_path());
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    throw MapError("no map can be stored in " + fs::path(file).parent_path().string() + ": folder " + folder.string() +
                   " cannot be written; choose another map folder or change its permissions");
  }
}

}  // namespace perennial
