// rosrun perennial_nav dataset_to_bag DATASET TRAVERSAL OUT.bag: one traversal of a data set as a bag of
// images and odometry, to be taught from or registered by the nodes.
#include <cv_bridge/cv_bridge.h>
#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <sensor_msgs/image_encodings.h>

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "perennial/core/csv.h"
#include "perennial/core/dataset.h"
#include "perennial/core/dataset_track.h"
#include "perennial/core/error.h"
#include "perennial/core/utc_time.h"

namespace {

namespace fs = std::filesystem;

constexpr char kUsage[] =
    R"(usage: dataset_to_bag DATASET TRAVERSAL OUT.bag [options]

Writes the images of one traversal of a data set (a folder with manifest.csv), with odometry, into a bag.

  --camera NAME        name of the camera, the images' frame (the data set's name)
  --image-topic NAME   (/camera/image_raw)
  --odom-topic NAME    (/odom)
  --from M, --to M     only places from M to M metres: for data sets whose places are of different cameras
  --speed M/S          driven where the data set's stamps are no drive (0.5)
  --ground-truth FILE  add the images' stamps, places and offsets to this table, for evaluate
  --overwrite          replace OUT.bag if it exists

Exit status: 0 done, 1 an input is bad, 2 the call is wrong.
)";

struct Options {
  std::vector<std::string> words;
  std::string camera;
  std::string image_topic = "/camera/image_raw";
  std::string odom_topic = "/odom";
  std::string ground_truth;
  double from_m = 0.0;
  double to_m = std::numeric_limits<double>::infinity();
  double speed_m_s = 0.5;
  bool overwrite = false;
};

class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

double number(const std::string& option, const std::string& text) {
  std::size_t used = 0;
  double value = std::numeric_limits<double>::quiet_NaN();
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used != text.size() || !(value >= 0.0)) {
    throw UsageError(option + " takes a number that is not negative, not '" + text + "'");
  }
  return value;
}

Options parse(const std::vector<std::string>& arguments) {
  Options options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    const auto value = [&]() -> const std::string& {
      if (i + 1 == arguments.size()) {
        throw UsageError(word + " needs a value");
      }
      return arguments[++i];
    };
    if (word == "--camera") {
      options.camera = value();
    } else if (word == "--image-topic") {
      options.image_topic = value();
    } else if (word == "--odom-topic") {
      options.odom_topic = value();
    } else if (word == "--ground-truth") {
      options.ground_truth = value();
    } else if (word == "--from") {
      options.from_m = number(word, value());
    } else if (word == "--to") {
      options.to_m = number(word, value());
    } else if (word == "--speed") {
      options.speed_m_s = number(word, value());
    } else if (word == "--overwrite") {
      options.overwrite = true;
    } else if (word.rfind("--", 0) == 0) {
      throw UsageError("unknown option " + word);
    } else {
      options.words.push_back(word);
    }
  }
  if (options.words.size() != 3) {
    throw UsageError("DATASET, TRAVERSAL and OUT.bag are needed");
  }
  if (options.speed_m_s <= 0.0) {
    throw UsageError("--speed must be positive");
  }
  return options;
}

nav_msgs::Odometry odometryMessage(const perennial::OdometrySample& sample) {
  nav_msgs::Odometry message;
  message.header.stamp = ros::Time(sample.stamp_s);
  message.header.frame_id = "odom";
  message.child_frame_id = "base_link";
  message.pose.pose.position.x = sample.x_m;
  message.pose.pose.orientation.w = 1.0;
  message.twist.twist.linear.x = sample.forward_m_s;
  return message;
}

void requireSize(const cv::Mat& image, cv::Size size, const perennial::Dataset& dataset,
                 const perennial::DatasetRow& row) {
  if (image.size() != size) {
    throw perennial::DatasetError(
        dataset.manifest + ":" + std::to_string(row.line) + ": " + row.image +
        " differs in size from the images before it; choose the places of one camera with "
        "--from and --to");
  }
}

/// With the bag's stamps, which need not be the data set's.
void addGroundTruth(const std::string& file, const std::vector<perennial::DatasetRow>& rows,
                    const perennial::DatasetTrack& track) {
  const bool begin = !fs::exists(file);
  std::ofstream stream(file, std::ios::app);
  stream << std::setprecision(17) << (begin ? "traversal,stamp,distance_m,offset_px\n" : "");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    stream << perennial::csvField(rows[i].traversal) << "," << perennial::formatUtc(track.image_stamps_s[i])
           << "," << rows[i].distance_m << "," << rows[i].offset_px << "\n";
  }
  stream.close();
  if (!stream) {
    throw perennial::Error(file + " cannot be written");
  }
}

int convert(const Options& options) {
  const perennial::Dataset dataset = perennial::loadDataset(options.words[0]);
  std::vector<perennial::DatasetRow> rows;
  for (const perennial::DatasetRow& row : dataset.traversal(options.words[1])) {
    if (row.distance_m >= options.from_m && row.distance_m <= options.to_m) {
      rows.push_back(row);
    }
  }
  const perennial::DatasetTrack track = perennial::trackOf(rows, options.speed_m_s);
  const std::string& file = options.words[2];
  if (fs::exists(file) && !options.overwrite) {
    throw perennial::Error(file + " exists already; say --overwrite to replace it");
  }
  const std::string camera =
      options.camera.empty() ? fs::canonical(options.words[0]).filename().string() : options.camera;

  const std::string partial = file + ".partial";  // the bag appears when it is complete
  rosbag::Bag bag(partial, rosbag::bagmode::Write);
  std::size_t next_image = 0;
  cv::Size size;
  for (const perennial::OdometrySample& sample : track.odometry) {
    const nav_msgs::Odometry odometry = odometryMessage(sample);
    bag.write(options.odom_topic, odometry.header.stamp, odometry);
    if (next_image < rows.size() && sample.stamp_s == track.image_stamps_s[next_image]) {
      const cv::Mat image = dataset.readImage(rows[next_image]);
      size = next_image == 0 ? image.size() : size;
      requireSize(image, size, dataset, rows[next_image]);
      cv_bridge::CvImage message(odometry.header, sensor_msgs::image_encodings::MONO8, image);
      message.header.frame_id = camera;
      bag.write(options.image_topic, odometry.header.stamp, message.toImageMsg());
      ++next_image;
    }
  }
  bag.close();
  fs::rename(partial, file);
  if (!options.ground_truth.empty()) {
    addGroundTruth(options.ground_truth, rows, track);
  }
  if (track.stamps_replaced) {
    std::cout << "the data set's stamps are no drive; time runs at " << options.speed_m_s << " m/s\n";
  }
  std::cout << file << ": " << rows.size() << " images of " << camera << ", " << track.odometry.size()
            << " odometry messages, " << track.odometry.back().x_m - track.odometry.front().x_m << " m\n";
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  for (const std::string& word : arguments) {
    if (word == "-h" || word == "--help") {
      std::cout << kUsage;
      return EXIT_SUCCESS;
    }
  }
  try {
    return convert(parse(arguments));
  } catch (const UsageError& error) {
    std::cerr << "dataset_to_bag: " << error.what() << "\n\n" << kUsage;
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "dataset_to_bag: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
}
