#include <yaml-cpp/yaml.h>

#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "map_commands.h"
#include "perennial/core/error.h"
#include "perennial/core/map_file.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

/// Enough digits that reading a number gives the same bits.
std::string exact(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.17g", value);
  return text;
}
std::string exact(float value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.9g", static_cast<double>(value));
  return text;
}

/// The 32 bytes in the order in which they are stored.
std::string hexadecimal(const Descriptor& descriptor) {
  std::string text;
  for (std::uint64_t word : descriptor.words) {
    for (int byte = 0; byte < 8; ++byte, word >>= 8) {
      char digits[3];
      std::snprintf(digits, sizeof(digits), "%02x", static_cast<unsigned>(word & 0xFF));
      text += digits;
    }
  }
  return text;
}

std::string numbered(std::uint32_t index, const char* suffix) {
  char text[32];
  std::snprintf(text, sizeof(text), "%06" PRIu32 "%s", index, suffix);
  return text;
}

void writeFile(const fs::path& file, const char* bytes, std::size_t size) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(bytes, static_cast<std::streamsize>(size));
  stream.close();
  if (!stream) {
    throw MapError("'" + file.string() +
                   "' cannot be written: check the disk's free space and the folder's permissions");
  }
}
void writeFile(const fs::path& file, const std::string& text) { writeFile(file, text.data(), text.size()); }

std::string featuresCsv(const LocalMap& map) {
  std::string text = "id,x,y,scale,response,descriptor";
  for (std::size_t k = 0; k < map.numbers_per_feature; ++k) {
    text += ",number_" + std::to_string(k);
  }
  text += "\n";
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Keypoint& keypoint = map.features.keypoints[i];
    text += std::to_string(map.ids[i]) + "," + exact(keypoint.x) + "," + exact(keypoint.y) + "," +
            exact(keypoint.scale) + "," + exact(keypoint.response) + "," +
            hexadecimal(map.features.descriptors[i]);
    for (std::size_t k = 0; k < map.numbers_per_feature; ++k) {
      text += "," + exact(map.featureNumbers(i)[k]);
    }
    text += "\n";
  }
  return text;
}

std::string metadataYaml(const MapFile& map) {
  const MapMetadata& metadata = map.metadata();
  YAML::Emitter yaml;
  yaml << YAML::BeginMap;
  const auto add = [&yaml](const char* key, const auto& value) {
    yaml << YAML::Key << key << YAML::Value << value;
  };
  yaml << YAML::Key << "name" << YAML::Value << YAML::DoubleQuoted << metadata.name;
  yaml << YAML::Key << "camera" << YAML::Value << YAML::DoubleQuoted << metadata.camera;
  add("image_width", metadata.image_width);
  add("image_height", metadata.image_height);
  add("image_encoding", metadata.image_encoding);
  add("extraction", metadata.extraction);
  add("map_interval_m", exact(metadata.map_interval_m));
  add("taught_stamp_s", exact(metadata.taught_stamp_s));
  add("length_m", exact(metadata.length_m));
  add("local_maps", map.size());
  yaml << YAML::Key << "traversals" << YAML::Value << YAML::BeginSeq;
  for (const TraversalInfo& traversal : map.traversals()) {
    yaml << YAML::Flow << YAML::BeginMap;
    add("traversal", traversal.id);
    yaml << YAML::Key << "strategy" << YAML::Value << YAML::DoubleQuoted << traversal.strategy;
    add("start_stamp_s", exact(traversal.start_stamp_s));
    add("end_stamp_s", exact(traversal.end_stamp_s));
    add("updated_maps", traversal.updated_maps);
    yaml << YAML::EndMap;
  }
  yaml << YAML::EndSeq << YAML::EndMap << YAML::Newline;
  return yaml.c_str();
}

std::string profileYaml(const PathProfile& profile) {
  YAML::Emitter yaml;
  yaml << YAML::BeginSeq;
  for (const ProfileEntry& entry : profile.entries()) {
    yaml << YAML::Flow << YAML::BeginMap;
    yaml << YAML::Key << "distance_m" << YAML::Value << exact(entry.distance_m);
    yaml << YAML::Key << "forward" << YAML::Value << exact(entry.velocity.forward);
    yaml << YAML::Key << "angular" << YAML::Value << exact(entry.velocity.angular);
    yaml << YAML::Key << "flipper" << YAML::Value << exact(entry.velocity.flipper);
    yaml << YAML::EndMap;
  }
  yaml << YAML::EndSeq << YAML::Newline;
  return yaml.c_str();
}

void prepare(const fs::path& folder) {
  std::error_code problem;
  if (fs::exists(folder, problem) && !(fs::is_directory(folder, problem) && fs::is_empty(folder, problem))) {
    throw MapError("'" + folder.string() + "' exists and is not an empty folder: choose another with --out");
  }
  for (const char* part : {"images", "features"}) {
    fs::create_directories(folder / part, problem);
    if (problem) {
      throw MapError("folder '" + (folder / part).string() + "' cannot be created: " + problem.message());
    }
  }
}

}  // namespace

void exportMap(const std::string& file, const std::string& folder, std::ostream& out) {
  const MapFile map(file);
  const fs::path target(folder);
  prepare(target);
  writeFile(target / "metadata.yaml", metadataYaml(map));
  writeFile(target / "profile.yaml", profileYaml(map.profile()));
  std::ofstream index(target / "local_maps.csv");
  index << "index,distance_m,stamp_s,features,strategy,map_numbers\n";
  for (std::uint32_t i = 0; i < map.size(); ++i) {
    const LocalMap local = map.read(i);
    index << i << "," << exact(local.distance_m) << "," << exact(local.stamp_s) << "," << local.size() << ","
          << local.strategy << ",";
    for (std::size_t k = 0; k < local.map_numbers.size(); ++k) {
      index << (k == 0 ? "" : " ") << exact(local.map_numbers[k]);
    }
    index << "\n";
    writeFile(target / "features" / numbered(i, ".csv"), featuresCsv(local));
    const std::vector<std::uint8_t> png = map.readImagePng(i);
    writeFile(target / "images" / numbered(i, ".png"), reinterpret_cast<const char*>(png.data()), png.size());
  }
  index.close();
  if (!index) {
    throw MapError("'" + (target / "local_maps.csv").string() +
                   "' cannot be written: check the disk's free space");
  }
  out << map.size() << " local maps exported to '" << folder << "'\n";
}

}  // namespace perennial
