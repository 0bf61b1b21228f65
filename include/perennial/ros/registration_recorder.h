#pragma once

#include <ros/ros.h>

#include <string>
#include <vector>

#include "perennial/core/dataset.h"
#include "perennial/core/parameter_reader.h"
#include "perennial/evaluation/run_results.h"
#include "perennial_nav/Registration.h"

namespace perennial {

struct RegistrationRecorderSettings {
  std::string folder;  ///< for the results; empty: nothing is recorded
  std::string
      ground_truth;      ///< table of the images' places and offsets (bag_dataset.h); empty: there is none
  std::string map_file;  ///< the map that is repeated, for the sizes of its local maps

  /// Keys as the members are called. Throws ParameterError.
  static RegistrationRecorderSettings load(ParameterReader& reader);
};

/// Writes down what the nodes' registrations find, in the files that `evaluate` writes. One thread.
///
/// The first traversal of the ground truth, by name, is the one that taught. Registrations against a place
/// without ground truth, and images whose stamps it does not know, have none. Times are not measured.
class RegistrationRecorder {
 public:
  /// Throws DatasetError for a malformed ground truth, MapError for the map.
  RegistrationRecorder(ros::NodeHandle nh, RegistrationRecorderSettings settings);

  bool isConnected() const { return subscriber_.getNumPublishers() > 0; }
  /// Whether the registration of an image of this time, or of a later one, has come.
  bool hasReached(const ros::Time& stamp) const { return newest_ >= stamp; }

  /// `name`: of the bag, for results without ground truth; `run`: what the nodes were set to. Throws Error.
  void write(const std::string& name, const RunSettings& run);

 private:
  void onRegistration(const perennial_nav::Registration& message);
  RegistrationRecord recordOf(const perennial_nav::Registration& message) const;

  ros::Subscriber subscriber_;
  RegistrationRecorderSettings settings_;
  std::vector<DatasetRow> truth_;
  std::vector<std::size_t> map_features_;  ///< of each local map, as the traversal finds them
  std::vector<RegistrationRecord> records_;
  ros::Time newest_;
};

}  // namespace perennial
