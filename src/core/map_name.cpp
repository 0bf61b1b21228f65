#include "perennial/core/map_name.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "perennial/core/error.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostNamesInError = 30;
constexpr std::string_view kAllowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-";

/// The folder itself or, while it does not exist, the nearest one above it that does.
fs::path nearestExisting(fs::path folder) {
  std::error_code ignored;
  while (!fs::exists(folder, ignored) && folder.has_parent_path() && folder != folder.parent_path()) {
    folder = folder.parent_path();
  }
  return folder;
}

bool endsWithSuffix(const std::string& name) {
  const std::string_view suffix = kMapSuffix;
  return name.size() >= suffix.size() &&
         name.compare(name.size() - suffix.size(), suffix.size(), suffix) == 0;
}

/// Why it is no name, "" when it is one.
std::string nameProblem(const std::string& name) {
  if (name.empty()) {
    return "it is empty";
  }
  if (name.size() > kMaxMapNameLength) {
    return "it is longer than " + std::to_string(kMaxMapNameLength) + " characters";
  }
  if (name.front() == '.' || name.front() == '-') {
    return "it begins with a dot or a hyphen";
  }
  if (name.find_first_not_of(kAllowed) != std::string::npos) {
    return "it has other characters than letters, digits, '_', '.' and '-'";
  }
  if (endsWithSuffix(name)) {
    return std::string("give it without '") + kMapSuffix + "'";
  }
  return "";
}

/// For error messages: a name may hold anything.
std::string printable(std::string name) {
  name.resize(std::min(name.size(), kMaxMapNameLength));
  std::replace_if(
      name.begin(), name.end(), [](char c) { return (c >= 0 && c < ' ') || c == 0x7F; }, '?');
  return name;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMostNamesInError); ++i) {
    text += (i == 0 ? "" : ", ") + names[i];
  }
  if (names.size() > kMostNamesInError) {
    text += " and " + std::to_string(names.size() - kMostNamesInError) + " more";
  }
  return names.empty() ? "it has no maps; teach one first" : "its maps are: " + text;
}

}  // namespace

void requireMapName(const std::string& name) {
  const std::string problem = nameProblem(name);
  if (!problem.empty()) {
    throw MapError("'" + printable(name) + "' cannot be the name of a map: " + problem);
  }
}

std::string mapFile(const std::string& folder, const std::string& name) {
  requireMapName(name);
  return (fs::path(folder) / (name + kMapSuffix)).string();
}

std::string existingMapFile(const std::string& folder, const std::string& name) {
  std::string file = mapFile(folder, name);
  std::error_code problem;
  if (!fs::exists(file, problem)) {
    throw MapError("there is no map '" + name + "' in folder '" + folder + "'; " + listed(listMaps(folder)));
  }
  return file;
}

std::vector<std::string> listMaps(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code problem;
  fs::directory_iterator entry(folder, problem);
  for (; !problem && entry != fs::directory_iterator(); entry.increment(problem)) {
    const std::string name = entry->path().filename().string();
    if (endsWithSuffix(name) && nameProblem(entry->path().stem().string()).empty()) {
      names.push_back(entry->path().stem().string());
    }
  }
  if (problem && problem != std::errc::no_such_file_or_directory) {
    throw MapError("map folder '" + folder + "' cannot be read: " + problem.message() +
                   ". Choose another folder or change its permissions");
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
    throw MapError("no map can be stored in " + fs::path(file).parent_path().string() + ": folder " +
                   folder.string() +
                   " cannot be written; choose another map folder or change its permissions");
  }
}

}  // namespace perennial
