#include "perennial/ros/teach_recorder.h"

#include <iomanip>
#include <sstream>
#include <utility>

#include "perennial/core/error.h"
#include "perennial/core/map_name.h"
#include "perennial/ros/conversions.h"
#include "perennial/ros/parameters.h"
#include "perennial/ros/reconfigure.h"
#include "perennial_nav/Processed.h"

namespace perennial {
namespace {

constexpr char kNode[] = "teach_recorder";
/// Images kept while their odometry is on its way.
constexpr std::size_t kImagesKept = 30;

}  // namespace

TeachRecorderSettings TeachRecorderSettings::load(ParameterReader& reader) {
  TeachRecorderSettings settings;
  settings.map_folder = reader.text("map_folder", settings.map_folder);
  if (settings.map_folder.empty()) {
    throw ParameterError("parameter map_folder is missing: name the folder in which maps are stored");
  }
  settings.camera = reader.text("camera", settings.camera);
  settings.every_image = reader.boolean("every_image", settings.every_image);
  settings.image_watch = ImageWatchSettings::load(reader);
  return settings;
}

TeachRecorder::TeachRecorder(ros::NodeHandle nh, ros::NodeHandle private_nh)
    : nh_(std::move(nh)),
      private_nh_(std::move(private_nh)),
      settings_(loadNode<TeachRecorderSettings>(private_nh_, {"extraction", "teaching", "odometer"})),
      teach_settings_(loadGroup<TeachSettings>(private_nh_, "teaching")),
      extraction_(loadGroup<ExtractionSettings>(private_nh_, "extraction")),
      odometer_(loadGroup<OdometerSettings>(private_nh_, "odometer")),
      images_(settings_.every_image ? 0 : kImagesKept),
      image_watch_(settings_.image_watch),
      transport_(nh_),
      reconfigure_(ros::NodeHandle(private_nh_, "extraction")),
      diagnostics_(nh_, private_nh_),
      server_(nh_, "teach", false) {
  path_publisher_ = nh_.advertise<nav_msgs::Path>("taught_path", 1, true);
  processed_publisher_ = nh_.advertise<perennial_nav::Processed>("processed", 100);
  reconfigure_.setCallback([this](auto& config, uint32_t level) { onReconfigure(config, level); });
  diagnostics_.setHardwareID("none");
  diagnostics_.add("teaching", [this](auto& status) { diagnose(status); });
  diagnostics_timer_ =
      nh_.createTimer(ros::Duration(0.5), [this](const ros::TimerEvent&) { diagnostics_.update(); });
  server_.registerGoalCallback([this] { onGoal(); });
  server_.registerPreemptCallback([this] { onPreempt(); });

  const auto queue = static_cast<uint32_t>(settings_.every_image ? 0 : kImagesKept);
  odometry_subscriber_ = nh_.subscribe("odom", 1000, &TeachRecorder::onOdometry, this);
  command_subscriber_ = nh_.subscribe("cmd_vel", 100, &TeachRecorder::onCommand, this);
  image_subscriber_ = transport_.subscribe("image", queue, &TeachRecorder::onImage, this);
  server_.start();
}

TeachRecorder::~TeachRecorder() {
  if (session_) {
    ROS_INFO("the node ends while teaching");
    const perennial_nav::TeachResult result = finish();
    server_.setPreempted(result, result.message);
  }
}

void TeachRecorder::onGoal() {
  if (session_) {
    const perennial_nav::TeachResult result = finish();
    server_.setPreempted(result, result.message);
  }
  const auto goal = server_.acceptNewGoal();
  try {
    begin(*goal);
  } catch (const Error& error) {
    abort(error.what());
  }
}

void TeachRecorder::begin(const perennial_nav::TeachGoal& goal) {
  MapMetadata metadata;
  metadata.name = goal.map_name;
  metadata.camera = settings_.camera;
  session_ = std::make_unique<TeachSession>(mapFile(settings_.map_folder, goal.map_name), metadata,
                                            static_cast<bool>(goal.overwrite), teach_settings_, extraction_);
  odometer_.reset();
  odometry_watch_.reset();
  images_.clear();
  image_watch_.reset();
  path_ = nav_msgs::Path();
  refused_images_ = 0;
  last_refusal_.clear();
  if (last_command_) {
    session_->addCommand(0.0, *last_command_);
  }
  ROS_INFO("teaching map '%s'", goal.map_name.c_str());
}

void TeachRecorder::onPreempt() {
  if (!session_) {
    return;
  }
  const perennial_nav::TeachResult result = finish();
  server_.setPreempted(result, result.message);
}

perennial_nav::TeachResult TeachRecorder::finish() {
  processPending();
  const std::unique_ptr<TeachSession> session = endSession();
  perennial_nav::TeachResult result;
  if (!session) {
    result.message = last_refusal_;
    return result;
  }
  result.distance_m = session->distance(odometer_.newestDistance());
  try {
    const TeachSummary summary = session->finish(odometer_.newestDistance());
    result.success = true;
    result.file = summary.file;
    result.distance_m = summary.distance_m;
    result.local_maps = static_cast<uint32_t>(summary.local_maps);
    result.features = static_cast<uint32_t>(summary.features);
    std::ostringstream message;
    message << std::fixed << std::setprecision(2) << "taught " << summary.local_maps << " local maps along "
            << summary.distance_m << " m in " << summary.file;
    result.message = message.str();
    ROS_INFO("%s", result.message.c_str());
  } catch (const Error& error) {
    result.message = error.what();
    if (!last_refusal_.empty()) {
      result.message += " (" + std::to_string(refused_images_) +
                        " images were refused, the last because: " + last_refusal_ + ")";
    }
    ROS_ERROR("%s", result.message.c_str());
  }
  return result;
}

std::unique_ptr<TeachSession> TeachRecorder::endSession() {
  for (; !images_.empty(); images_.pop()) {
    acknowledge(images_.front());  // nobody may wait for an image that will not be used
  }
  return std::move(session_);
}

void TeachRecorder::abort(const std::string& reason) {
  ROS_ERROR("teaching failed: %s", reason.c_str());
  endSession();
  last_refusal_ = reason;
  perennial_nav::TeachResult result;
  result.message = reason;
  server_.setAborted(result, reason);
}

void TeachRecorder::onCommand(const geometry_msgs::TwistConstPtr& message) {
  const Velocity velocity = fromMessage(*message);
  try {
    if (session_) {
      session_->addCommand(odometer_.newestDistance(), velocity);
    }
    last_command_ = velocity;
  } catch (const Error& error) {
    ROS_WARN_THROTTLE(1.0, "command refused: %s", error.what());
  }
}

void TeachRecorder::onOdometry(const nav_msgs::OdometryConstPtr& message) {
  if (!session_) {
    return;
  }
  if (!settings_.every_image && odometry_watch_.restarted(message->header.seq)) {
    abort("the node of the odometry was started anew, and nobody knows how far the robot went meanwhile");
    return;
  }
  const OdometrySample sample = fromMessage(*message);
  const std::string problem = odometer_.add(sample);
  if (!problem.empty()) {
    // Left out, it would still shift the rest of the path: the next sample is far from the last good one.
    abort(problem);
    return;
  }
  session_->addMeasuredVelocity(odometer_.newestDistance(), {sample.forward_m_s, sample.angular_rad_s, 0.0});
  newest_pose_.header = message->header;
  newest_pose_.pose = message->pose.pose;
  processPending();
}

void TeachRecorder::onImage(const sensor_msgs::ImageConstPtr& image) {
  if (!session_) {
    acknowledge(image);
    return;
  }
  if (const std::string problem = image_watch_.checkStamp(image->header.stamp.toSec()); !problem.empty()) {
    acknowledge(image);
    abort(problem);  // which of them is where, nobody knows
    return;
  }
  images_.push(image);
  processPending();
}

void TeachRecorder::processPending() {
  while (session_ && !images_.empty()) {
    const sensor_msgs::ImageConstPtr image = images_.front();
    const std::optional<OdometrySample> newest = odometer_.newest();
    const double stamp_s = image->header.stamp.toSec();
    if (!newest || newest->stamp_s < stamp_s) {
      return;
    }
    images_.pop();
    const std::optional<double> travelled_m = odometer_.distanceAt(stamp_s);
    if (travelled_m) {
      process(image, *travelled_m);
    }
    acknowledge(image);
  }
}

void TeachRecorder::process(const sensor_msgs::ImageConstPtr& image, double travelled_m) {
  try {
    if (settings_.camera.empty()) {
      session_->nameCamera(image->header.frame_id);
    }
    if (session_->addImage(image->header.stamp.toSec(), travelled_m, greyImage(image), image->encoding)) {
      publishProgress();
    }
    const std::string problem = image_watch_.checkPixels(image->data.data(), image->data.size(), travelled_m);
    if (!problem.empty()) {
      abort(problem);
    }
  } catch (const ImageError& error) {
    ++refused_images_;
    last_refusal_ = error.what();
    ROS_WARN_THROTTLE(1.0, "image refused: %s", error.what());
  } catch (const Error& error) {
    abort(error.what());
  }
}

void TeachRecorder::publishProgress() {
  perennial_nav::TeachFeedback feedback;
  feedback.distance_m = session_->distance(odometer_.newestDistance());
  feedback.local_maps = static_cast<uint32_t>(session_->localMaps());
  feedback.features = static_cast<uint32_t>(session_->newestFeatures());
  server_.publishFeedback(feedback);
  path_.header = newest_pose_.header;
  path_.poses.push_back(newest_pose_);
  if (path_publisher_.getNumSubscribers() > 0) {
    path_publisher_.publish(path_);
  }
}

void TeachRecorder::acknowledge(const sensor_msgs::ImageConstPtr& image) {
  perennial_nav::Processed processed;
  processed.header = image->header;
  processed.node = kNode;
  processed_publisher_.publish(processed);
}

void TeachRecorder::onReconfigure(perennial_nav::ExtractionConfig& config, uint32_t level) {
  if (level == kFirstReconfigure || session_) {
    toConfig(extraction_, config);  // our own strict values first; and never while a map is being taught
    return;
  }
  extraction_ = fromConfig(config);
}

void TeachRecorder::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (!session_) {
    status.summary(DiagnosticStatus::OK, "idle");
  } else if (refused_images_ > 0) {
    status.summary(DiagnosticStatus::WARN, "teaching; images refused: " + last_refusal_);
  } else {
    status.summary(DiagnosticStatus::OK, "teaching");
  }
  status.add("distance_m", session_ ? session_->distance(odometer_.newestDistance()) : 0.0);
  status.add("local maps", session_ ? session_->localMaps() : 0);
  status.add("features in the newest", session_ ? session_->newestFeatures() : 0);
  status.add("images refused", refused_images_);
  status.add("images dropped", images_.dropped());
}

}  // namespace perennial
