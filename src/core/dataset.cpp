#include "perennial/core/dataset.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <tuple>

#include "perennial/core/csv.h"
#include "perennial/core/error.h"
#include "perennial/core/utc_time.h"

namespace perennial {
namespace {

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
  if (table.text(row, "image").empty()) {
    table.fail(row, "no image is named");
  }
  result.image = folder + "/" + table.text(row, "image");
  result.offset_px = table.number(row, "offset_px");
  return result;
}

std::string at(const Dataset& dataset, const DatasetRow& row) {
  return dataset.manifest + ":" + std::to_string(row.line) + ": ";
}

/// Rows of one place, in order of the traversals' names.
void checkPlace(const Dataset& dataset, const std::vector<DatasetRow>& place) {
  for (std::size_t k = 1; k < place.size(); ++k) {
    const DatasetRow& before = place[k - 1];
    const DatasetRow& row = place[k];
    const std::string other = " (line " + std::to_string(before.line) + ")";
    if (row.traversal == before.traversal) {
      throw DatasetError(at(dataset, row) + "traversal '" + row.traversal + "' has this place already" +
                         other);
    }
    if (row.stamp_s < before.stamp_s) {
      throw DatasetError(at(dataset, row) + "time goes backwards at this place: traversal '" + row.traversal +
                         "' is earlier than '" + before.traversal + "'" + other);
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

cv::Mat Dataset::readImage(const DatasetRow& row) const {
  cv::Mat image = cv::imread(row.image, cv::IMREAD_GRAYSCALE);
  if (image.empty()) {
    throw DatasetError(at(*this, row) + "the image " + row.image +
                       " cannot be read; is it there, and an image?");
  }
  return image;
}

Dataset loadDataset(const std::string& folder) {
  Dataset dataset;
  dataset.manifest = folder + "/manifest.csv";
  const CsvTable table = CsvTable::load(dataset.manifest);
  for (const CsvRow& row : table.rows()) {
    dataset.rows.push_back(parseRow(table, row, folder));
  }
  if (dataset.rows.empty()) {
    throw DatasetError(dataset.manifest + ": has a header, but no rows");
  }
  std::stable_sort(dataset.rows.begin(), dataset.rows.end(), [](const DatasetRow& a, const DatasetRow& b) {
    return std::tie(a.traversal, a.distance_m) < std::tie(b.traversal, b.distance_m);
  });
  for (const auto& place : dataset.places()) {
    checkPlace(dataset, place.second);
  }
  return dataset;
}

}  // namespace perennial
