#include "perennial/ros/registration_recorder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "perennial/core/map_file.h"
#include "perennial/ros/bag_dataset.h"

namespace perennial {
namespace {

constexpr double kSameTime_s = 1e-4;
constexpr double kSamePlace_m = 0.05;
const double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

bool samePlace(double a_m, double b_m) { return std::abs(a_m - b_m) < kSamePlace_m; }

}  // namespace

RegistrationRecorderSettings RegistrationRecorderSettings::load(ParameterReader& reader) {
  RegistrationRecorderSettings settings;
  settings.folder = reader.text("folder", settings.folder);
  settings.ground_truth = reader.text("ground_truth", settings.ground_truth);
  settings.map_file = reader.text("map_file", settings.map_file);
  return settings;
}

RegistrationRecorder::RegistrationRecorder(ros::NodeHandle nh, RegistrationRecorderSettings settings)
    : settings_(std::move(settings)) {
  if (!settings_.ground_truth.empty()) {
    truth_ = loadGroundTruth(settings_.ground_truth);
    std::stable_sort(truth_.begin(), truth_.end(),
                     [](const DatasetRow& a, const DatasetRow& b) { return a.traversal < b.traversal; });
  }
  // Before the traversal begins: what it teaches is not in the file before it ends.
  const MapFile map(settings_.map_file);
  for (std::uint32_t i = 0; i < map.size(); ++i) {
    map_features_.push_back(map.read(i).size());
  }
  subscriber_ = nh.subscribe("registration", 1000, &RegistrationRecorder::onRegistration, this);
}

void RegistrationRecorder::onRegistration(const perennial_nav::Registration& message) {
  newest_ = std::max(newest_, message.header.stamp);
  records_.push_back(recordOf(message));
}

RegistrationRecord RegistrationRecorder::recordOf(const perennial_nav::Registration& message) const {
  RegistrationRecord record;
  record.stamp_s = message.header.stamp.toSec();
  record.distance_m = message.local_map_distance_m;
  if (message.has_displacement) {
    record.step.displacement_px = message.displacement_px;
  }
  record.step.inliers = message.inliers;
  record.step.matches = message.matches;
  record.step.map_features = map_features_.at(message.local_map);
  record.step.registration_ms = kNotMeasured;
  const auto view = std::find_if(truth_.begin(), truth_.end(), [&](const DatasetRow& row) {
    return std::abs(row.stamp_s - record.stamp_s) < kSameTime_s &&
           samePlace(row.distance_m, record.distance_m);
  });
  if (view == truth_.end()) {
    return record;
  }
  record.traversal = view->traversal;
  record.stamp_s = view->stamp_s;
  record.distance_m = view->distance_m;
  const auto taught = std::find_if(truth_.begin(), truth_.end(), [&](const DatasetRow& row) {
    return row.traversal == truth_.front().traversal && samePlace(row.distance_m, record.distance_m);
  });
  if (taught != truth_.end()) {
    record.ground_truth_px = groundTruthDisplacement(*taught, *view);
  }
  return record;
}

void RegistrationRecorder::write(const std::string& name, const RunSettings& run) {
  RunOutput output;
  output.input = name + " on map " + settings_.map_file;
  output.ms_per_extraction = kNotMeasured;
  output.records = records_;
  for (RegistrationRecord& record : output.records) {
    record.traversal = record.traversal.empty() ? name : record.traversal;
  }
  writeRun(settings_.folder, run, output);
  ROS_INFO("%zu registrations written to %s", records_.size(), settings_.folder.c_str());
}

}  // namespace perennial
