#include "perennial/ros/repeat_navigator.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

#include <cv_bridge/cv_bridge.h>
#include <opencv2/imgcodecs.hpp>
#include <sensor_msgs/image_encodings.h>

#include "perennial/core/error.h"
#include "perennial/core/matches_picture.h"
#include "perennial/ros/conversions.h"
#include "perennial/ros/parameters.h"
#include "perennial/ros/reconfigure.h"
#include "perennial_nav/Processed.h"
#include "perennial_nav/Registration.h"

namespace perennial {
namespace {

using perennial_nav::NavigationState;

constexpr char kNode[] = "repeat_navigator";
/// The odometry has moved when the travelled distance grew by this much; less is its noise.
constexpr double kProgress_m = 0.02;
/// Local map messages kept for their images.
constexpr std::size_t kMessagesKept = 64;
/// Images kept while their odometry is on its way.
constexpr std::size_t kImagesKept = 30;
/// Real time to wait for simulated time to begin.
const ros::WallDuration kClockPatience(5.0);

std::string seconds(double value) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << value << " s";
  return text.str();
}

const std::vector<std::string> kGroups{"extraction", "registration", "steering", "along_path", "odometer"};

}  // namespace

RepeatNavigatorSettings RepeatNavigatorSettings::load(ParameterReader& reader) {
  RepeatNavigatorSettings settings;
  settings.every_image = reader.boolean("every_image", settings.every_image);
  settings.sensor_timeout_s = reader.real("sensor_timeout_s", settings.sensor_timeout_s, 0.05, 3600.0);
  settings.give_up_s = reader.real("give_up_s", settings.give_up_s, 0.1, 1e9);
  settings.stall_timeout_s = reader.real("stall_timeout_s", settings.stall_timeout_s, 0.0, 3600.0);
  return settings;
}

RepeatNavigator::RepeatNavigator(ros::NodeHandle nh, ros::NodeHandle private_nh)
    : nh_(std::move(nh)),
      private_nh_(std::move(private_nh)),
      settings_(loadNode<RepeatNavigatorSettings>(private_nh_, kGroups)),
      repeat_settings_{loadGroup<ExtractionSettings>(private_nh_, "extraction"),
                       loadGroup<RegistrationSettings>(private_nh_, "registration"),
                       loadGroup<SteeringSettings>(private_nh_, "steering"),
                       loadGroup<AlongPathSettings>(private_nh_, "along_path")},
      odometer_(loadGroup<OdometerSettings>(private_nh_, "odometer")),
      images_(settings_.every_image ? 0 : kImagesKept),
      traversals_(nh_),
      gate_(nh_, settings_.sensor_timeout_s),
      transport_(nh_),
      extraction_server_(ros::NodeHandle(private_nh_, "extraction")),
      registration_server_(ros::NodeHandle(private_nh_, "registration")),
      steering_server_(ros::NodeHandle(private_nh_, "steering")),
      diagnostics_(nh_, private_nh_),
      server_(nh_, "repeat", false) {
  registration_publisher_ = nh_.advertise<perennial_nav::Registration>("registration", 1000);
  state_publisher_ = nh_.advertise<NavigationState>("navigation_state", 100, true);
  processed_publisher_ = nh_.advertise<perennial_nav::Processed>("processed", 100);
  matches_publisher_ = transport_.advertise("matches", 1);
  setUpReconfigure();
  setUpDiagnostics();
  server_.registerGoalCallback([this] { onGoal(); });
  server_.registerPreemptCallback([this] { onPreempt(); });

  camera_info_subscriber_ = nh_.subscribe("camera_info", 10, &RepeatNavigator::onCameraInfo, this);
  odometry_subscriber_ = nh_.subscribe("odom", 1000, &RepeatNavigator::onOdometry, this);
  map_subscriber_ = nh_.subscribe("local_maps", 1000, &RepeatNavigator::onLocalMap, this);
  const uint32_t queue = settings_.every_image ? 0 : 2;
  image_subscriber_ = transport_.subscribe("image", queue, &RepeatNavigator::onImage, this);
  setState(NavigationState::IDLE, "waiting for a goal");
  server_.start();
}

RepeatNavigator::~RepeatNavigator() {
  if (run_) {
    endRun(false, "the navigator is being shut down");
  }
}

// --- goals -----------------------------------------------------------------------------------------------------------

void RepeatNavigator::onGoal() {
  if (run_) {
    server_.setPreempted(endRun(false, "another goal came"), "another goal came");
  }
  const auto goal = server_.acceptNewGoal();
  try {
    startRun(*goal);
  } catch (const Error& error) {
    fail(error.what());
  }
}

void RepeatNavigator::startRun(const perennial_nav::RepeatGoal& goal) {
  run_ = std::make_unique<Run>();
  run_->goal = goal;
  if (!ros::Time::waitForValid(kClockPatience)) {
    throw Error("there is no time: /use_sim_time is set, but nobody publishes /clock");
  }
  run_->goal.traversals = std::max<std::uint32_t>(1, goal.traversals);
  run_->newest_stamp = run_->progress_stamp = ros::Time::now();
  odometer_.reset();
  images_.clear();
  setState(NavigationState::STARTING, "waiting for image, odometry and local maps");
  beginTraversal(goal.start_distance_m, std::nullopt, run_->newest_stamp);
  ROS_INFO("repeating map '%s'", goal.map_name.c_str());
}

void RepeatNavigator::beginTraversal(double start_m, std::optional<double> travelled_m, const ros::Time& stamp) {
  const auto response = traversals_.begin(run_->goal.map_name, start_m, stamp);
  if (!run_->session) {
    if (!(start_m >= 0.0 && start_m < response.length_m)) {
      throw MapError("start distance " + std::to_string(start_m) + " m does not lie on the path, which is " +
                     std::to_string(response.length_m) + " m long");
    }
    run_->session = std::make_unique<RepeatSession>(metadataFromMessage(response, run_->goal.map_name),
                                                    fromMessage(response.profile), response.local_maps,
                                                    repeat_settings_);
  }
  run_->start_m = start_m;
  run_->messages.clear();
  run_->session->beginTraversal(start_m, travelled_m);
}

void RepeatNavigator::onPreempt() {
  if (run_) {
    server_.setPreempted(endRun(false, "cancelled"), "cancelled");
    setState(NavigationState::IDLE, "cancelled; waiting for a goal");
  }
}

void RepeatNavigator::fail(const std::string& reason) {
  ROS_ERROR("repeat failed: %s", reason.c_str());
  server_.setAborted(endRun(false, reason), reason);
  setState(NavigationState::FAILED, reason);
}

perennial_nav::RepeatResult RepeatNavigator::endRun(bool success, const std::string& reason) {
  gate_.stop();
  const std::unique_ptr<Run> run = std::move(run_);
  perennial_nav::RepeatResult result;
  result.success = static_cast<std::uint8_t>(success);
  result.reason = reason;
  if (run && run->session) {
    const double here_m = run->session->distance(run->travelled_m);
    result.traversals = success ? run->goal.traversals : run->number - 1;
    result.distance_m = success ? run->driven_m : run->driven_m + std::max(0.0, here_m - run->start_m);
  }
  try {
    traversals_.end(false, ros::Time::now());
  } catch (const Error& error) {
    ROS_WARN("%s", error.what());
  }
  for (; !images_.empty(); images_.pop()) {
    acknowledge(images_.front());
  }
  return result;
}

// --- sensors ---------------------------------------------------------------------------------------------------------

void RepeatNavigator::onImage(const sensor_msgs::ImageConstPtr& image) {
  if (!run_) {
    acknowledge(image);
    return;
  }
  images_.push(image);
  processPending();
}

void RepeatNavigator::onCameraInfo(const sensor_msgs::CameraInfoConstPtr& info) { camera_info_ = info; }

void RepeatNavigator::onOdometry(const nav_msgs::OdometryConstPtr& message) {
  if (!run_) {
    return;
  }
  const std::string problem = odometer_.add(fromMessage(*message));
  if (!problem.empty()) {
    fail(problem + "; check the odometry topic");
    return;
  }
  processPending();
}

void RepeatNavigator::onLocalMap(const perennial_nav::LocalMapConstPtr& message) {
  if (!run_ || !run_->session || message->traversal != traversals_.id()) {
    ++ignored_maps_;
    return;
  }
  try {
    run_->session->add(fromMessage(*message));
  } catch (const Error& error) {
    ROS_ERROR_THROTTLE(1.0, "local map refused: %s", error.what());
    return;
  }
  run_->messages[message->index] = message;
  if (run_->messages.size() > kMessagesKept) {
    run_->messages.erase(run_->messages.begin());
  }
  processPending();
}

void RepeatNavigator::onTimer() {
  diagnostics_.update();
  if (!run_) {
    return;
  }
  const double silent_s = (ros::Time::now() - run_->newest_stamp).toSec();
  if (silent_s <= settings_.sensor_timeout_s) {
    return;
  }
  std::string missing = "image";
  if (!images_.empty()) {
    const auto newest = odometer_.newest();
    const bool has_odometry = newest && newest->stamp_s >= images_.front()->header.stamp.toSec();
    missing = has_odometry ? "local map" : "odometry";
  }
  const std::string reason = "no " + missing + " for " + seconds(silent_s);
  if (silent_s > settings_.give_up_s) {
    fail(reason + "; check its topic");
  } else {
    setState(NavigationState::STOPPED, reason);
  }
}

// --- images ----------------------------------------------------------------------------------------------------------

void RepeatNavigator::processPending() {
  while (run_ && !images_.empty()) {
    const sensor_msgs::ImageConstPtr image = images_.front();
    const double stamp_s = image->header.stamp.toSec();
    const std::optional<OdometrySample> newest = odometer_.newest();
    if (!newest || newest->stamp_s < stamp_s) {
      return;  // its odometry is still to come
    }
    if (!settings_.every_image && images_.size() > 1 && images_.second()->header.stamp.toSec() <= newest->stamp_s) {
      images_.drop();
      acknowledge(image);
      continue;
    }
    const std::optional<double> travelled_m = odometer_.distanceAt(stamp_s);
    if (travelled_m) {
      if (!run_->session->ready(*travelled_m)) {
        return;  // its local map is still to come
      }
      try {
        process(image, *travelled_m);
      } catch (const Error& error) {
        fail(error.what());
        return;
      }
    }
    if (run_ && !images_.empty()) {
      images_.pop();
      acknowledge(image);
    }
  }
}

void RepeatNavigator::process(const sensor_msgs::ImageConstPtr& image, double travelled_m) {
  const cv::Mat grey = greyImage(image);
  run_->session->requireSuitable(grey, image->encoding);
  run_->session->setFocalLength(focalLength(grey.cols));
  run_->session->stepInto(image->header.stamp.toSec(), travelled_m, grey, step_);
  const NavigationStep& step = step_;
  run_->travelled_m = travelled_m;
  run_->newest_stamp = image->header.stamp;
  send(step, image);
  if (run_->session->atEnd(travelled_m)) {
    completeTraversal(image->header.stamp);
  } else {
    watchProgress(step, image->header.stamp);
  }
}

void RepeatNavigator::send(const NavigationStep& step, const sensor_msgs::ImageConstPtr& image) {
  const bool last = run_->number == run_->goal.traversals && run_->session->atEnd(run_->travelled_m);
  if (last) {
    gate_.stop();
  } else if (!gate_.drive(step.velocity, image->header.stamp)) {
    ROS_WARN_THROTTLE(1.0, "an image came too late to drive by");
  }
  perennial_nav::Registration registration = toMessage(step);
  registration.header = image->header;
  registration.traversal = traversals_.id();
  registration_publisher_.publish(registration);
  traversals_.countRegistration();

  state_ = NavigationState::REPEATING;
  reason_ = step.registration.result.displacement_px ? "" : "this image could not be registered; driving by odometry";
  publishState(image->header.stamp, &step);
  perennial_nav::RepeatFeedback feedback;
  feedback.distance_m = step.distance_m;
  feedback.traversal = run_->number;
  feedback.has_displacement = static_cast<std::uint8_t>(registration.has_displacement);
  feedback.displacement_px = registration.displacement_px;
  feedback.inliers = registration.inliers;
  feedback.state = state_;
  server_.publishFeedback(feedback);
  if (matches_publisher_.getNumSubscribers() > 0) {
    publishMatches(step, image);
  }
}

void RepeatNavigator::watchProgress(const NavigationStep& step, const ros::Time& stamp) {
  const bool moved = std::abs(run_->travelled_m - run_->progress_m) > kProgress_m;
  if (moved || std::abs(step.velocity.forward) < 1e-3) {
    run_->progress_m = run_->travelled_m;
    run_->progress_stamp = stamp;
    return;
  }
  const double stalled_s = (stamp - run_->progress_stamp).toSec();
  if (settings_.stall_timeout_s > 0.0 && stalled_s > settings_.stall_timeout_s) {
    fail("the robot is driven, but its odometry has not moved for " + seconds(stalled_s) +
         ": is it blocked, or the odometry topic wrong?");
  }
}

void RepeatNavigator::completeTraversal(const ros::Time& stamp) {
  Run& run = *run_;
  const double overshoot_m = run.session->distance(run.travelled_m) - run.session->length();
  run.driven_m += run.session->length() - run.start_m;
  try {
    const std::uint32_t updated = traversals_.end(true, stamp);
    ROS_INFO("traversal %u of '%s' done, %u local maps learned something", run.number, run.goal.map_name.c_str(),
             updated);
  } catch (const Error& error) {
    ROS_ERROR("%s", error.what());  // the map stays as it was; the robot can go on
  }
  if (run.number == run.goal.traversals) {
    const std::string reason = "repeated '" + run.goal.map_name + "' " + std::to_string(run.number) + " times";
    server_.setSucceeded(endRun(true, reason), reason);
    setState(NavigationState::FINISHED, reason);
    return;
  }
  ++run.number;
  beginTraversal(std::min(overshoot_m, run.session->length()), run.travelled_m, stamp);
}

// --- what others see -------------------------------------------------------------------------------------------------

void RepeatNavigator::setState(const std::string& state, const std::string& reason) {
  if (state != state_) {
    ROS_INFO("%s: %s", state.c_str(), reason.c_str());
  }
  state_ = state;
  reason_ = reason;
  publishState(ros::Time::now(), nullptr);
}

void RepeatNavigator::publishState(const ros::Time& stamp, const NavigationStep* step) {
  NavigationState message;
  message.header.stamp = stamp;
  message.state = state_;
  message.reason = reason_;
  message.command = gate_.newest();
  if (run_) {
    message.map = run_->goal.map_name;
    message.traversal = run_->number;
  }
  if (run_ && run_->session) {
    message.distance_m = run_->session->distance(run_->travelled_m);
    message.length_m = run_->session->length();
  }
  if (step != nullptr) {
    const RegistrationResult& result = step->registration.result;
    message.has_displacement = static_cast<std::uint8_t>(result.displacement_px.has_value());
    message.displacement_px = result.displacement_px.value_or(0.0);
    message.inliers = result.inliers;
  }
  state_publisher_.publish(message);
}

void RepeatNavigator::publishMatches(const NavigationStep& step, const sensor_msgs::ImageConstPtr& image) {
  const auto entry = run_->messages.find(step.local_map);
  if (entry == run_->messages.end()) {
    return;
  }
  const perennial_nav::LocalMap& message = *entry->second;
  const cv::Mat map_image = cv::imdecode(message.image.data, cv::IMREAD_GRAYSCALE);
  const ActiveMap map = fromMessage(message);
  const cv::Mat picture =
      drawMatches(map_image, greyImage(image), map.alternatives[step.registration.alternative].features, step.view,
                  step.registration.result);
  matches_publisher_.publish(
      cv_bridge::CvImage(image->header, sensor_msgs::image_encodings::BGR8, picture).toImageMsg());
}

void RepeatNavigator::acknowledge(const sensor_msgs::ImageConstPtr& image) {
  perennial_nav::Processed processed;
  processed.header = image->header;
  processed.node = kNode;
  processed.has_command = static_cast<std::uint8_t>(run_ != nullptr);
  processed.command = gate_.newest();
  processed_publisher_.publish(processed);
}

std::optional<double> RepeatNavigator::focalLength(int image_width) const {
  if (!camera_info_ || camera_info_->K[0] <= 0.0 || camera_info_->width == 0) {
    return std::nullopt;
  }
  return camera_info_->K[0] * image_width / camera_info_->width;
}

void RepeatNavigator::setUpReconfigure() {
  extraction_server_.setCallback([this](perennial_nav::ExtractionConfig& config, uint32_t level) {
    if (level == kFirstReconfigure || run_) {
      toConfig(repeat_settings_.extraction, config);  // a run keeps the settings its map was taught with
    } else {
      repeat_settings_.extraction = fromConfig(config);
    }
  });
  registration_server_.setCallback([this](perennial_nav::RegistrationConfig& config, uint32_t level) {
    if (level == kFirstReconfigure) {
      toConfig(repeat_settings_.registration, config);
      return;
    }
    repeat_settings_.registration = fromConfig(config);
    if (run_ && run_->session) {
      run_->session->setRegistration(repeat_settings_.registration);
    }
  });
  steering_server_.setCallback([this](perennial_nav::SteeringConfig& config, uint32_t level) {
    if (level == kFirstReconfigure) {
      toConfig(repeat_settings_.steering, config);
      return;
    }
    repeat_settings_.steering = fromConfig(config);
    if (run_ && run_->session) {
      run_->session->setSteering(repeat_settings_.steering);
    }
  });
}

void RepeatNavigator::setUpDiagnostics() {
  diagnostics_.setHardwareID("none");
  diagnostics_.add("navigation", [this](auto& status) { diagnose(status); });
  timer_ = nh_.createTimer(ros::Duration(0.1), [this](const ros::TimerEvent&) { onTimer(); });
}

void RepeatNavigator::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  const std::string text = reason_.empty() ? state_ : state_ + ": " + reason_;
  if (state_ == NavigationState::FAILED) {
    status.summary(DiagnosticStatus::ERROR, text);
  } else if (state_ == NavigationState::STOPPED || (state_ == NavigationState::REPEATING && !reason_.empty())) {
    status.summary(DiagnosticStatus::WARN, text);
  } else {
    status.summary(DiagnosticStatus::OK, text);
  }
  status.add("map", run_ ? run_->goal.map_name : "none");
  status.add("traversal", run_ ? run_->number : 0);
  status.add("distance_m", run_ && run_->session ? run_->session->distance(run_->travelled_m) : 0.0);
  status.add("camera_info", camera_info_ ? "known" : "missing: the gain per pixel is used");
  status.add("images dropped", images_.dropped());
  status.add("stale local maps ignored", ignored_maps_);
}

}  // namespace perennial
