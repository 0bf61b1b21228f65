#include "perennial/ros/bag_dataset.h"

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/Image.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "perennial/core/csv.h"
#include "perennial/core/error.h"
#include "perennial/core/utc_time.h"
#include "perennial/ros/conversions.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

constexpr double kSameTime_s = 1e-4;

/// Rows by their stamps, which need not be unique: several cameras may have taken an image at once.
class RowsByTime {
 public:
  explicit RowsByTime(const std::vector<DatasetRow>& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows_.emplace(rows[i].stamp_s, i);
    }
  }

  std::vector<std::size_t> at(double stamp_s) const {
    std::vector<std::size_t> found;
    for (auto row = rows_.lower_bound(stamp_s - kSameTime_s); row != rows_.upper_bound(stamp_s + kSameTime_s);
         ++row) {
      found.push_back(row->second);
    }
    return found;
  }

 private:
  std::multimap<double, std::size_t> rows_;
};

/// Writes the images of a bag that rows ask for; fills in the rows' file names.
void extractImages(const std::string& file, const std::string& topic, const std::string& folder,
                   const RowsByTime& wanted, std::vector<DatasetRow>& rows) {
  rosbag::Bag bag;
  try {
    bag.open(file, rosbag::bagmode::Read);
  } catch (const rosbag::BagException& error) {
    throw Error("bag " + file + " cannot be read: " + error.what());
  }
  rosbag::View view(bag, rosbag::TopicQuery(topic));
  if (view.size() == 0) {
    throw Error("bag " + file + " has nothing on the topic " + topic);
  }
  for (const rosbag::MessageInstance& message : view) {
    const sensor_msgs::ImageConstPtr image = message.instantiate<sensor_msgs::Image>();
    if (!image) {
      throw Error("bag " + file + ": " + topic + " does not hold sensor_msgs/Image");
    }
    for (const std::size_t i : wanted.at(image->header.stamp.toSec())) {
      char name[32];
      std::snprintf(name, sizeof(name), "%06zu.png", i);
      if (!cv::imwrite(folder + "/" + name, greyImage(image))) {
        throw Error(folder + "/" + name + " cannot be written");
      }
      rows[i].image = name;
    }
  }
}

std::string exact(double value) {
  std::ostringstream text;
  text << std::setprecision(17) << value;
  return text.str();
}

}  // namespace

std::vector<DatasetRow> loadGroundTruth(const std::string& file) {
  const CsvTable table = CsvTable::load(file);
  std::vector<DatasetRow> rows;
  for (const CsvRow& line : table.rows()) {
    DatasetRow row;
    row.line = line.line;
    row.traversal = table.text(line, "traversal");
    const auto stamp = parseUtc(table.text(line, "stamp"));
    if (row.traversal.empty() || !stamp) {
      table.fail(line, row.traversal.empty()
                           ? "the traversal has no name"
                           : "'" + table.text(line, "stamp") + "' in column 'stamp' is not a time");
    }
    row.stamp_s = *stamp;
    row.distance_m = table.number(line, "distance_m");
    row.offset_px = table.number(line, "offset_px");
    rows.push_back(row);
  }
  if (rows.empty()) {
    throw DatasetError(file + ": has a header, but no rows");
  }
  return rows;
}

void writeBagDataset(const std::vector<std::string>& bags, const std::string& image_topic,
                     const std::string& ground_truth, const std::string& folder,
                     std::vector<std::string>& problems) {
  std::vector<DatasetRow> rows = loadGroundTruth(ground_truth);
  const RowsByTime wanted(rows);
  std::error_code error;
  fs::create_directories(folder, error);
  for (const std::string& bag : bags) {
    extractImages(bag, image_topic, folder, wanted, rows);
  }
  std::ofstream manifest(folder + "/manifest.csv");
  manifest << "traversal,stamp,distance_m,image,offset_px\n";
  for (const DatasetRow& row : rows) {
    if (row.image.empty()) {
      problems.push_back(ground_truth + ":" + std::to_string(row.line) + ": no bag has an image of " +
                         formatUtc(row.stamp_s) + " on " + image_topic);
      continue;
    }
    manifest << csvField(row.traversal) << "," << formatUtc(row.stamp_s) << "," << exact(row.distance_m)
             << "," << row.image << "," << exact(row.offset_px) << "\n";
  }
  manifest.close();
  if (!manifest) {
    throw Error(folder + "/manifest.csv cannot be written");
  }
}

}  // namespace perennial
