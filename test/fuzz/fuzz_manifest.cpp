// Any bytes are refused as a manifest, or give a data set whose rows are all found again: by traversal, by
// place, along the track of each traversal, and after the table was written and read once more.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include "perennial/core/csv.h"
#include "perennial/core/dataset.h"
#include "perennial/core/dataset_track.h"
#include "perennial/core/error.h"

namespace {

using perennial::CsvRow;
using perennial::CsvTable;
using perennial::Dataset;

constexpr double kLongest_m = 100.0;  // of which a track is made: it takes a sample every 5 cm

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

void checkTracks(const Dataset& dataset) {
  std::size_t rows = 0;
  for (const std::string& name : dataset.traversals()) {
    const std::vector<perennial::DatasetRow> traversal = dataset.traversal(name);
    rows += traversal.size();
    if (traversal.back().distance_m - traversal.front().distance_m < kLongest_m) {
      const perennial::DatasetTrack track = perennial::trackOf(traversal, 1.0);
      require(track.image_stamps_s.size() == traversal.size() && track.odometry.size() >= traversal.size());
    }
  }
  require(rows == dataset.rows.size());
  std::size_t placed = 0;
  for (const auto& place : dataset.places()) {
    placed += place.second.size();
  }
  require(placed == rows);
}

void checkWritten(const CsvTable& table, const std::string& header) {
  std::ostringstream text;
  text << header << "\n";
  for (const CsvRow& row : table.rows()) {
    for (std::size_t i = 0; i < row.fields.size(); ++i) {
      text << (i == 0 ? "" : ",") << perennial::csvField(row.fields[i]);
    }
    text << "\n";
  }
  std::istringstream written(text.str());
  const CsvTable again = CsvTable::parse(written, "written.csv");
  require(again.rows().size() == table.rows().size());
  for (std::size_t i = 0; i < table.rows().size(); ++i) {
    require(again.rows()[i].fields == table.rows()[i].fields);
  }
}

/// A header with as many columns as the rows have.
std::string headerOf(const CsvTable& table) {
  std::string header = "0";
  for (std::size_t i = 1; i < table.rows().front().fields.size(); ++i) {
    header += "," + std::to_string(i);
  }
  return header;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream content(std::string(data, data + size));
  try {
    const CsvTable table = CsvTable::parse(content, "folder/manifest.csv");
    if (!table.rows().empty() && table.rows().front().fields.size() > 1) {
      checkWritten(table, headerOf(table));
    }
    checkTracks(perennial::datasetOf(table, "folder"));
  } catch (const perennial::DatasetError&) {
    // refused, as it should be
  }
  return 0;
}
