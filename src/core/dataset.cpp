#include "perennial/core/dataset.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <tuple>

#include "perennial/core/error.h"
#include "perennial/core/reference_map.h"
#include "perennial/core/utc_time.h"

namespace perennial {
namespace {

constexpr double kLongestPath_m = 1e6;  // a track has a sample every few centimetres

DatasetRow parseRow(const CsvTable& table, const CsvRow& row, const std::string& folder) {
  DatasetRow result;
  result.line = row.line;
  result.traversal = table.text(row, "traversal");
  if (result.traversal.empty()) {
    table.fail(row, "the traversal has no name");
  }
  const auto stamp = parseUtc(table.text(row, "stamp"));
  if (!stamp) {
    table.fail(
        row, "'" + table.text(row, "stamp") + "' in column 'stamp' is not a time like 2014-09-27T05:27:00Z");
  }
  result.stamp_s = *stamp;
  result.distance_m = table.number(row, "distance_m");
  if (result.distance_m < 0.0) {
    table.fail(row, "the distance is negative");
  }
  if (result.distance_m > kLongestPath_m) {
    table.fail(row, "the distance is more than 1000 km; is it in metres?");
  }
  if (table.text(row, "image").empty()) {
    table.fail(row, "no image is named");
  }
  result.image = folder + "/" + table.text(row, "image");
  result.offset_px = table.number(row, "offset_px");
  return result;
}

/// How another row is called in a message.
std::string other(const DatasetRow& row) {
  return row.line == 0 ? " (" + row.image + ")" : " (line " + std::to_string(row.line) + ")";
}

/// Rows of one place, in order of the traversals' names.
void checkPlace(const Dataset& dataset, const std::vector<DatasetRow>& place) {
  for (std::size_t k = 1; k < place.size(); ++k) {
    const DatasetRow& before = place[k - 1];
    const DatasetRow& row = place[k];
    if (row.traversal == before.traversal) {
      throw DatasetError(dataset.at(row) + "traversal '" + row.traversal + "' has this place already" +
                         other(before));
    }
    if (row.stamp_s < before.stamp_s) {
      throw DatasetError(dataset.at(row) + "time goes backwards at this place: traversal '" + row.traversal +
                         "' is earlier than '" + before.traversal + "'" + other(before));
    }
  }
}

}  // namespace

std::vector<std::string> Dataset::traversals() const {
  std::vector<std::string> names;
  for (const DatasetRow& row : rows) {
    if (names.empty() || names.back() != row.traversal) {
      names.push_back(row.traversal);
    }
  }
  return names;
}

std::vector<DatasetRow> Dataset::traversal(const std::string& name) const {
  std::vector<DatasetRow> result;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(result),
               [&](const DatasetRow& row) { return row.traversal == name; });
  if (result.empty()) {
    std::string known;
    for (const std::string& other : traversals()) {
      known += (known.empty() ? "" : ", ") + other;
    }
    throw DatasetError(manifest + ": there is no traversal '" + name + "', only: " + known);
  }
  return result;
}

std::map<double, std::vector<DatasetRow>> Dataset::places() const {
  std::map<double, std::vector<DatasetRow>> result;
  for (const DatasetRow& row : rows) {
    result[row.distance_m].push_back(row);
  }
  return result;
}

std::string Dataset::at(const DatasetRow& row) const {
  return row.line == 0 ? row.image + ": " : manifest + ":" + std::to_string(row.line) + ": ";
}

std::string Dataset::readFile(const DatasetRow& row) const {
  std::ifstream stream(row.image, std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();
  if (!stream || content.str().empty()) {
    throw DatasetError(at(row) + "the image " + row.image + " cannot be read; is it there, and an image?");
  }
  return content.str();
}

cv::Mat Dataset::decodeImage(const DatasetRow& row, const std::string& content) const {
  if (row.line == 0) {
    const ReferenceLocalMap map = decodeReferenceMap(content, row.image);
    if (map.image.empty()) {
      throw DatasetError(at(row) + "holds no Image to extract features from, only stored ones");
    }
    return map.image;
  }
  cv::Mat image = cv::imdecode(std::vector<char>(content.begin(), content.end()), cv::IMREAD_GRAYSCALE);
  if (image.empty()) {
    throw DatasetError(at(row) + row.image + " is not an image");
  }
  return image;
}

cv::Mat Dataset::readImage(const DatasetRow& row) const { return decodeImage(row, readFile(row)); }

void sortAndCheck(Dataset& dataset) {
  std::stable_sort(dataset.rows.begin(), dataset.rows.end(), [](const DatasetRow& a, const DatasetRow& b) {
    return std::tie(a.traversal, a.distance_m) < std::tie(b.traversal, b.distance_m);
  });
  for (const auto& place : dataset.places()) {
    checkPlace(dataset, place.second);
  }
}

Dataset loadDataset(const std::string& folder) {
  const std::string manifest = folder + "/manifest.csv";
  if (!std::filesystem::exists(manifest) && !listReferenceMaps(folder).empty()) {
    return loadReferenceDataset(folder);
  }
  return datasetOf(CsvTable::load(manifest), folder);
}

Dataset datasetOf(const CsvTable& table, const std::string& folder) {
  Dataset dataset;
  dataset.manifest = table.file();
  for (const CsvRow& row : table.rows()) {
    dataset.rows.push_back(parseRow(table, row, folder));
  }
  if (dataset.rows.empty()) {
    throw DatasetError(dataset.manifest + ": has a header, but no rows");
  }
  sortAndCheck(dataset);
  return dataset;
}

}  // namespace perennial
