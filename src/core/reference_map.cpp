#include "perennial/core/reference_map.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <opencv2/core/persistence.hpp>
#include <opencv2/imgproc.hpp>
#include <regex>
#include <sstream>
#include <tuple>

#include "perennial/core/error.h"
#include "perennial/core/utc_time.h"

namespace perennial {
namespace {

/// Standard deviation of the Gaussian that a box filter approximates, by the filter's size (Bay et al., CVIU
/// 2008), which is what the reference system's detector calls a keypoint's size.
constexpr float kScaleOfSize = 1.2F / 9.0F;

std::string contentOf(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();
  if (!stream || content.str().empty()) {
    throw DatasetError(file + ": cannot be read, or is empty");
  }
  return content.str();
}

/// OpenCV writes one document, its names at the beginning of lines and everything else indented. It reads
/// other texts, too, but over some with indented names, with other things that are not, or with a second
/// document its parser runs for ever.
void requireAsWritten(const std::string& content, const std::string& file) {
  std::istringstream lines(content);
  std::string line;
  bool named = false;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (!line.empty() && line.back() == '\r') {
      line.pop_back();
    }
    const char first = line.empty() ? '#' : line[0];
    if (first == '#' || (!named && (first == '%' || line == "---"))) {
      continue;
    }
    const bool indented = first == ' ' || first == '\t';
    const bool name = std::isalpha(static_cast<unsigned char>(first)) != 0 || first == '_' || first == '"';
    if (indented ? !named : !name) {
      throw DatasetError(file + ":" + std::to_string(number) +
                         ": is no OpenCV FileStorage YAML: there, a name begins the line");
    }
    named = true;
  }
}

/// Calls `read` with the parsed YAML; what OpenCV throws becomes a DatasetError.
template <typename Read>
auto parsed(const std::string& content, const std::string& file, const Read& read) {
  try {
    // Without its first line OpenCV takes YAML for the name of a file.
    if (content.compare(0, 5, "%YAML") != 0) {
      throw DatasetError(file + ":1: is no OpenCV FileStorage YAML: it does not begin with %YAML");
    }
    requireAsWritten(content, file);
    const cv::FileStorage storage(
        content, cv::FileStorage::READ | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_YAML);
    return read(storage);
  } catch (const cv::Exception& error) {
    throw DatasetError(file + ": is no OpenCV FileStorage YAML: " + error.err);
  } catch (const DatasetError&) {
    throw;
  } catch (const std::exception& error) {  // the parser throws the standard library's, too
    throw DatasetError(file + ": is no OpenCV FileStorage YAML: " + error.what());
  }
}

/// A matrix that has the numbers it claims to have: OpenCV would allocate first, whatever the file says.
cv::Mat readMatrix(const cv::FileStorage& storage, const std::string& name, const std::string& file) {
  const cv::FileNode node = storage[name];
  if (node.empty()) {
    return cv::Mat();
  }
  const cv::FileNode rows = node["rows"];
  const cv::FileNode cols = node["cols"];
  const bool sized =
      rows.isInt() && cols.isInt() && static_cast<int>(rows) >= 0 && static_cast<int>(cols) >= 0;
  const std::size_t claimed = sized ? static_cast<std::size_t>(static_cast<int>(rows)) *
                                          static_cast<std::size_t>(static_cast<int>(cols))
                                    : 0;
  if (!sized || claimed > node["data"].size()) {
    throw DatasetError(file + ": " + name + " is no matrix, or has fewer numbers than rows and columns");
  }
  cv::Mat matrix;
  node >> matrix;
  return matrix;
}

void readImage(const cv::FileStorage& storage, const std::string& file, ReferenceLocalMap& map) {
  const cv::Mat image = readMatrix(storage, "Image", file);
  if (image.empty()) {
    return;
  }
  if (image.depth() != CV_8U || (image.channels() != 1 && image.channels() != 3)) {
    throw DatasetError(file + ": Image is not 8-bit with 1 or 3 channels");
  }
  map.coloured = image.channels() == 3;
  if (map.coloured) {
    cv::cvtColor(image, map.image, cv::COLOR_BGR2GRAY);
  } else {
    map.image = image;
  }
}

/// Rows of bytes, whether stored as such or as floats.
cv::Mat bytesOf(const cv::Mat& descriptors, const std::string& file) {
  if (descriptors.channels() != 1 || descriptors.cols > static_cast<int>(Descriptor::kBytes)) {
    throw DatasetError(file + ": Descriptors have " +
                       std::to_string(descriptors.cols * descriptors.channels()) +
                       " numbers each; only binary ones of up to 32 bytes can be compared by bits");
  }
  if (descriptors.depth() == CV_8U) {
    return descriptors;
  }
  cv::Mat bytes;
  descriptors.convertTo(bytes, CV_8U);
  cv::Mat back;
  bytes.convertTo(back, descriptors.type());
  // NaN is unequal to everything.
  if (cv::countNonZero(back == descriptors) != static_cast<int>(descriptors.total())) {
    throw DatasetError(file +
                       ": Descriptors hold numbers that are no bytes (whole, 0 to 255); descriptors of real "
                       "numbers cannot be compared by bits");
  }
  return bytes;
}

void readFeatures(const cv::FileStorage& storage, const std::string& file, ReferenceLocalMap& map) {
  std::vector<cv::KeyPoint> keypoints;
  if (!storage["Keypoints"].empty()) {
    cv::read(storage["Keypoints"], keypoints);
  }
  const cv::Mat stored = readMatrix(storage, "Descriptors", file);
  if (static_cast<std::size_t>(stored.rows) != keypoints.size()) {
    throw DatasetError(file + ": has " + std::to_string(keypoints.size()) + " Keypoints, but " +
                       std::to_string(stored.rows) + " Descriptors");
  }
  const cv::Mat bytes = keypoints.empty() ? cv::Mat() : bytesOf(stored, file);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const cv::KeyPoint& k = keypoints[i];
    if (!std::isfinite(k.pt.x) || !std::isfinite(k.pt.y) || !std::isfinite(k.size) ||
        !std::isfinite(k.response)) {
      throw DatasetError(file + ": keypoint " + std::to_string(i) + " is not finite");
    }
    Descriptor descriptor;
    std::memcpy(descriptor.words.data(), bytes.ptr(static_cast<int>(i)),
                static_cast<std::size_t>(bytes.cols));
    map.features.add({k.pt.x, k.pt.y, k.size * kScaleOfSize, k.response}, descriptor);
  }
  if (!storage["Ratings"].empty()) {
    storage["Ratings"] >> map.ratings;
  }
  if (!map.ratings.empty() && map.ratings.size() != keypoints.size()) {
    throw DatasetError(file + ": has " + std::to_string(keypoints.size()) + " Keypoints, but " +
                       std::to_string(map.ratings.size()) + " Ratings");
  }
}

/// Value of a line "Time: ..." at the top level.
std::optional<double> timeIn(const std::string& content, const std::string& file) {
  const std::size_t key = content.find("\nTime:");
  if (key == std::string::npos) {
    return std::nullopt;
  }
  const std::size_t begin = content.find_first_not_of(" \"'", key + 6);
  const std::size_t end = content.find_first_of("\"'\r\n", begin);
  const std::string text = begin == std::string::npos ? "" : content.substr(begin, end - begin);
  if (const auto utc = parseUtc(text)) {
    return utc;
  }
  char* rest = nullptr;
  const double stamp_s = std::strtod(text.c_str(), &rest);
  if (text.empty() || *rest != '\0' || !std::isfinite(stamp_s)) {
    const auto line =
        2 + std::count(content.begin(), content.begin() + static_cast<std::ptrdiff_t>(key), '\n');
    throw DatasetError(file + ":" + std::to_string(line) + ": '" + text +
                       "' is no time: seconds since 1970, or 2014-09-27T05:27:00Z");
  }
  return stamp_s;
}

}  // namespace

std::vector<ReferenceMapFile> listReferenceMaps(const std::string& folder) {
  static const std::regex pattern(R"((.+)_([0-9]+\.[0-9]{3})\.yaml)");
  std::vector<ReferenceMapFile> maps;
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator(folder, problem)) {
    const std::string file = entry.path().filename().string();
    std::smatch parts;
    if (std::regex_match(file, parts, pattern)) {
      maps.push_back({entry.path().string(), parts[1], std::strtod(parts[2].str().c_str(), nullptr)});
    }
  }
  std::sort(maps.begin(), maps.end(), [](const ReferenceMapFile& a, const ReferenceMapFile& b) {
    return std::tie(a.name, a.distance_m) < std::tie(b.name, b.distance_m);
  });
  return maps;
}

ReferenceLocalMap readReferenceMap(const std::string& file) {
  return decodeReferenceMap(contentOf(file), file);
}

ReferenceLocalMap decodeReferenceMap(const std::string& content, const std::string& file) {
  return parsed(content, file, [&](const cv::FileStorage& storage) {
    ReferenceLocalMap map;
    readImage(storage, file, map);
    readFeatures(storage, file, map);
    map.stamp_s = timeIn(content, file);
    if (map.image.empty() && map.features.empty()) {
      throw DatasetError(file + ": holds neither an Image nor Keypoints");
    }
    return map;
  });
}

std::optional<double> readReferenceTime(const std::string& file) { return timeIn(contentOf(file), file); }

PathProfile readReferenceProfile(const std::string& file) {
  return decodeReferenceProfile(contentOf(file), file);
}

PathProfile decodeReferenceProfile(const std::string& content, const std::string& file) {
  const auto numbers = parsed(content, file, [](const cv::FileStorage& storage) {
    std::vector<double> path;  // the text's numbers, not the nearest floats
    storage["Path"] >> path;
    return path;
  });
  if (numbers.empty() || numbers.size() % 4 != 0) {
    throw DatasetError(file + ": Path has " + std::to_string(numbers.size()) +
                       " numbers; it must be groups of distance, forward, angular, flipper");
  }
  PathProfile profile;
  try {
    for (std::size_t i = 0; i < numbers.size(); i += 4) {
      profile.add(numbers[i], {numbers[i + 1], numbers[i + 2], numbers[i + 3]});
    }
  } catch (const Error& error) {
    throw DatasetError(file + ": Path: " + error.what());
  }
  return profile;
}

std::vector<int> readReferenceOffsets(const std::string& file) {
  std::istringstream lines(contentOf(file));
  std::vector<int> offsets;
  std::size_t number = 1;
  for (std::string line; std::getline(lines, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) {
      continue;
    }
    std::istringstream fields(line);
    int offset = 0;
    int ignored = 0;
    std::string more;
    if (!(fields >> offset >> ignored) || fields >> more) {
      throw DatasetError(file + ":" + std::to_string(number) + ": '" + line + "' is not two integers");
    }
    offsets.push_back(offset);
  }
  return offsets;
}

}  // namespace perennial
