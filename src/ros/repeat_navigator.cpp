#include "perennial/ros/repeat_navigator.h"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "perennial/core/error.h"
#include "perennial/core/human_text.h"
#include "perennial/ros/conversions.h"
#include "perennial/ros/focal_length.h"

namespace perennial {
namespace {

/// The odometry has moved when the travelled distance grew by this much; less is its noise.
constexpr double kProgress_m = 0.02;
/// Images kept while their odometry is on its way.
constexpr std::size_t kImagesKept = 30;
/// Real time to wait for simulated time to begin.
const ros::WallDuration kClockPatience(5.0);
const ros::Duration kWatchPeriod(0.1);
/// Local maps asked for at once when a person backs the robot.
constexpr std::size_t kFetchedBehind = 20;

}  // namespace

RepeatNavigator::RepeatNavigator(ros::NodeHandle nh, ros::NodeHandle private_nh)
    : nh_(std::move(nh)),
      settings_(RepeatNavigatorSettings::load(private_nh)),
      odometer_(settings_.odometer),
      images_(settings_.every_image ? 0 : kImagesKept),
      image_watch_(settings_.supervisor.frozen_images),
      supervisor_(settings_.supervisor),
      traversals_(nh_),
      localiser_(nh_, traversals_,
                 {[this] { prepare(localiser_.progress()); },
                  [this](const auto& image, const auto& place) { onPlaceSought(image, place); },
                  [this](const std::string& reason) { fail(reason); }}),
      gate_(nh_, settings_.sensor_timeout_s, settings_.limits, settings_.interlock),
      inputs_(gate_, settings_.interlock),
      reporter_(nh_, private_nh),
      live_settings_(private_nh, settings_.repeat, [this] { return run_ ? run_->session.get() : nullptr; }),
      transport_(nh_),
      server_(nh_, "repeat", false) {
  server_.registerGoalCallback([this] { onGoal(); });
  server_.registerPreemptCallback([this] { onPreempt(); });
  camera_info_subscriber_ = nh_.subscribe<sensor_msgs::CameraInfo>(
      "camera_info", 10, [this](const sensor_msgs::CameraInfoConstPtr& info) { camera_info_ = info; });
  odometry_subscriber_ = nh_.subscribe("odom", 1000, &RepeatNavigator::onOdometry, this);
  map_subscriber_ = nh_.subscribe("local_maps", 1000, &RepeatNavigator::onLocalMap, this);
  const uint32_t queue = settings_.every_image ? 0 : 2;
  image_subscriber_ = transport_.subscribe("image", queue, &RepeatNavigator::onImage, this);
  timer_ = nh_.createTimer(kWatchPeriod, [this](const ros::TimerEvent&) { onTimer(); });
  publishState(ros::Time::now());
  server_.start();
}

RepeatNavigator::~RepeatNavigator() {
  if (run_) {
    const std::string reason = "the navigator is being shut down";
    server_.setAborted(endRun(false, reason), reason);
  }
}

// --- goals
// -----------------------------------------------------------------------------------------------------------

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
  run_ = std::make_unique<RepeatRun>();
  run_->goal = goal;
  if (!ros::Time::waitForValid(kClockPatience)) {
    throw Error("there is no time: /use_sim_time is set, but nobody publishes /clock");
  }
  const ros::Time now = ros::Time::now();
  run_->goal.traversals = std::max<std::uint32_t>(1, goal.traversals);
  run_->started = run_->progress_stamp = now;
  odometer_.reset();
  odometry_watch_.reset();
  images_.clear();
  image_watch_.reset();
  gate_.begin();
  supervisor_.start(now.toSec());
  publishState(now);
  run_->begun_m = goal.localise ? 0.0 : goal.start_distance_m;
  beginTraversal(run_->begun_m, std::nullopt, now);
  ROS_INFO("repeating map '%s'", goal.map_name.c_str());
  if (goal.localise) {
    gate_.stop();  // it stands until its place is known; simulated time waits for a command
    beginLocalisation();
  }
}

void RepeatNavigator::beginTraversal(double start_m, std::optional<double> travelled_m,
                                     const ros::Time& stamp) {
  const auto response = traversals_.begin(run_->goal.map_name, start_m, stamp);
  if (!run_->session) {
    if (!(start_m >= 0.0 && start_m < response.length_m)) {
      throw MapError("start distance " + std::to_string(start_m) + " m does not lie on the path, which is " +
                     std::to_string(response.length_m) + " m long");
    }
    run_->session =
        std::make_unique<RepeatSession>(metadataFromMessage(response, run_->goal.map_name),
                                        fromMessage(response.profile), response.local_maps, settings_.repeat);
  }
  run_->local_maps = response.local_maps;
  run_->start_m = start_m;
  run_->messages.clear();
  run_->session->beginTraversal(start_m, travelled_m);
}

void RepeatNavigator::onPreempt() {
  if (run_) {
    server_.setPreempted(endRun(false, "cancelled"), "cancelled");
    supervisor_.rest("cancelled; waiting for a goal");
    publishState(ros::Time::now());
  }
}

void RepeatNavigator::fail(const std::string& reason) {
  ROS_ERROR("repeat failed: %s", reason.c_str());
  server_.setAborted(endRun(false, reason), reason);
  supervisor_.fail(reason);
  publishState(ros::Time::now());
}

perennial_nav::RepeatResult RepeatNavigator::endRun(bool success, const std::string& reason) {
  gate_.stop();
  const std::unique_ptr<RepeatRun> run = std::move(run_);
  if (localiser_.searching()) {
    acknowledge(localiser_.image());
  }
  localiser_.end();
  perennial_nav::RepeatResult result;
  result.success = static_cast<std::uint8_t>(success);
  result.reason = reason;
  if (run && run->session) {
    result.start_distance_m = run->begun_m;
    result.certainty = run->certainty;
    result.traversals = success ? run->goal.traversals : run->number - 1;
    result.distance_m =
        success ? run->driven_m : run->driven_m + std::max(0.0, run->distance() - run->start_m);
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

// --- sensors
// ---------------------------------------------------------------------------------------------------------

void RepeatNavigator::onImage(const sensor_msgs::ImageConstPtr& image) {
  if (run_ && isFromBefore(image->header)) {
    acknowledge(image);
    return;
  }
  const std::string problem = run_ ? image_watch_.checkStamp(image->header.stamp.toSec()) : "";
  if (!run_ || !problem.empty()) {
    if (run_) {
      supervisor_.setImageProblem(problem);
      onTimer();  // stops at once
    }
    acknowledge(image);
    return;
  }
  images_.push(image);
  processPending();
}

void RepeatNavigator::onOdometry(const nav_msgs::OdometryConstPtr& message) {
  if (!run_ || isFromBefore(message->header)) {
    return;
  }
  if (!settings_.every_image && odometry_watch_.restarted(message->header.seq)) {
    fail("the node of the odometry was started anew, and nobody knows how far the robot went meanwhile");
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
  run_->keep(message);
  processPending();
}

bool RepeatNavigator::isFromBefore(const std_msgs::Header& header) const {
  return !settings_.every_image && header.stamp < run_->started;
}

std::string RepeatNavigator::missing() const {
  if (images_.empty()) {
    return "image";
  }
  const auto newest = odometer_.newest();
  const bool has_odometry = newest && newest->stamp_s >= images_.front()->header.stamp.toSec();
  return has_odometry ? "local map" : "odometry";
}

void RepeatNavigator::onTimer() {
  reporter_.update(images_.dropped(), ignored_maps_, camera_info_ != nullptr);
  if (!run_) {
    return;
  }
  if (!traversals_.managerAlive()) {
    fail("map_manager is gone: without it there are no local maps");
    return;
  }
  if (localiser_.searching()) {
    if (drivenByHand()) {
      const sensor_msgs::ImageConstPtr image = localiser_.image();
      beginLocalisation();
      acknowledge(image);
    } else {
      prepare(localiser_.progress());
    }
    return;
  }
  const NavigationStatus before = supervisor_.status();
  const ros::Time now = ros::Time::now();
  const NavigationStatus& status = supervisor_.watch(now.toSec(), missing(), gate_.permit());
  if (status.mode == NavigationMode::kFailed) {
    fail(status.reason);
    return;
  }
  if (status.mode == NavigationMode::kStopped && before.mode != NavigationMode::kStopped) {
    gate_.halt();
  }
  if (status.mode != before.mode || status.reason != before.reason) {
    publishState(now);
  }
}

// --- images
// ----------------------------------------------------------------------------------------------------------

void RepeatNavigator::processPending() {
  while (run_ && !images_.empty() && !localiser_.searching()) {
    const sensor_msgs::ImageConstPtr image = images_.front();
    const double stamp_s = image->header.stamp.toSec();
    const std::optional<OdometrySample> newest = odometer_.newest();
    if (!newest || newest->stamp_s < stamp_s) {
      return;  // its odometry is still to come
    }
    if (!settings_.every_image && images_.size() > 1 &&
        images_.second()->header.stamp.toSec() <= newest->stamp_s) {
      images_.drop();
      acknowledge(image);
      continue;
    }
    const std::optional<double> travelled_m = odometer_.distanceAt(stamp_s);
    if (travelled_m && !registerFront(*travelled_m)) {
      return;
    }
    if (run_ && !images_.empty()) {
      images_.pop();
      if (localiser_.image() != image) {
        acknowledge(image);
      }
    }
  }
}

/// Whether the first image of the queue is done with.
bool RepeatNavigator::registerFront(double travelled_m) {
  if (!localiser_.active() && !run_->session->ready(travelled_m)) {
    return false;  // its local map is still to come
  }
  try {
    process(images_.front(), travelled_m);
    return true;
  } catch (const Error& error) {
    fail(error.what());
    return false;
  }
}

void RepeatNavigator::process(const sensor_msgs::ImageConstPtr& image, double travelled_m) {
  const cv::Mat grey = greyImage(image);
  run_->session->requireSuitable(grey, image->encoding);
  followHand(travelled_m);
  run_->travelled_m = travelled_m;
  const std::string problem = image_watch_.checkPixels(image->data.data(), image->data.size(), travelled_m);
  supervisor_.setImageProblem(problem);
  if (!problem.empty()) {
    onTimer();
    return;
  }
  if (localiser_.active()) {
    seekPlace(image, grey, travelled_m);
    return;
  }
  run_->session->setFocalLength(focalLength(camera_info_, grey.cols));
  run_->session->stepInto(image->header.stamp.toSec(), travelled_m, grey, step_);
  drive(step_, image);
  if (!run_) {
    return;
  }
  std::this_thread::yield();  // roscpp sends by a thread of its own, which must not wait for what follows
  report(step_, image);
  if (run_->atEnd()) {
    completeTraversal(image->header.stamp);
  } else {
    run_->session->correctAlongPath(step_);  // only now: it takes as long again, and the command is out
    watchProgress(image->header.stamp);
  }
}

/// The odometer counts driving backwards like forwards, as paths are taught; but what a person backs, the
/// repeat has to drive again.
void RepeatNavigator::followHand(double travelled_m) {
  const bool backwards = odometer_.newest() && odometer_.newest()->forward_m_s < 0.0;
  if (backwards && gate_.permit().kind == MotionPermit::Kind::kManual) {
    run_->session->shift(-2.0 * (travelled_m - run_->travelled_m));
    fetchLocalMapsBehind(travelled_m);
  }
}

/// Local maps that were passed have been let go, and the manager sends none twice by itself.
void RepeatNavigator::fetchLocalMapsBehind(double travelled_m) {
  while (const auto first = run_->session->backedBefore(travelled_m)) {
    const std::size_t count = std::min<std::size_t>(*first, kFetchedBehind);
    std::vector<ActiveMap> maps = traversals_.localMaps(*first - count, count, true);
    if (maps.size() != count) {
      throw MapError("map_manager did not send the local maps before the " + std::to_string(*first) + "th");
    }
    for (auto map = maps.rbegin(); map != maps.rend(); ++map) {
      run_->session->add(std::move(*map));
    }
  }
}

void RepeatNavigator::drive(const NavigationStep& step, const sensor_msgs::ImageConstPtr& image) {
  const ros::Time& stamp = image->header.stamp;
  const NavigationStatus status =
      supervisor_.see(stamp.toSec(), run_->travelled_m, sightOf(step.registration.result), gate_.permit());
  if (status.mode == NavigationMode::kFailed) {
    fail(status.reason);
  } else if (run_->number == run_->goal.traversals && run_->atEnd()) {
    gate_.stop();
  } else if (!gate_.drive(slowed(step.velocity, status.speed_factor), stamp)) {
    ROS_WARN_THROTTLE(1.0, "an image came too late to drive by");
  }
}

void RepeatNavigator::report(const NavigationStep& step, const sensor_msgs::ImageConstPtr& image) {
  run_->count(step);
  perennial_nav::Registration registration = toMessage(step);
  registration.header = image->header;
  traversals_.publish(std::move(registration));
  publishState(image->header.stamp, &step);
  publishFeedback(&step);
  reporter_.matches(step, image, *run_);
}

void RepeatNavigator::publishFeedback(const NavigationStep* step) {
  perennial_nav::RepeatFeedback feedback;
  feedback.traversal = run_->number;
  feedback.state = nameOf(supervisor_.status().mode);
  feedback.reason = supervisor_.status().reason;
  if (step != nullptr) {
    const RegistrationResult& result = step->registration.result;
    feedback.distance_m = step->distance_m;
    feedback.has_displacement = static_cast<std::uint8_t>(result.displacement_px.has_value());
    feedback.displacement_px = result.displacement_px.value_or(0.0);
    feedback.inliers = result.inliers;
  }
  server_.publishFeedback(feedback);
}

void RepeatNavigator::watchProgress(const ros::Time& stamp) {
  const bool moved = std::abs(run_->travelled_m - run_->progress_m) > kProgress_m;
  if (moved || std::abs(gate_.newest().linear.x) < 1e-3) {
    run_->progress_m = run_->travelled_m;
    run_->progress_stamp = stamp;
    return;
  }
  const double stalled_s = (stamp - run_->progress_stamp).toSec();
  if (settings_.stall_timeout_s > 0.0 && stalled_s > settings_.stall_timeout_s) {
    fail("the robot is driven, but its odometry has not moved for " + humanSeconds(stalled_s) +
         ": is it blocked, or the odometry topic wrong?");
  }
}

void RepeatNavigator::completeTraversal(const ros::Time& stamp) {
  RepeatRun& run = *run_;
  const double overshoot_m = run.distance() - run.session->length();
  run.driven_m += run.session->length() - run.start_m;
  try {
    const std::uint32_t updated = traversals_.end(true, stamp);
    ROS_INFO("traversal %u of '%s' done, %u local maps learned something", run.number,
             run.goal.map_name.c_str(), updated);
  } catch (const Error& error) {
    ROS_ERROR("%s", error.what());  // the map stays as it was; the robot can go on
  }
  if (run.number == run.goal.traversals) {
    const std::string reason =
        "repeated '" + run.goal.map_name + "' " +
        (run.number == 1 ? "once" : std::to_string(run.number) + " times") +
        (run.goal.localise ? " from " + humanMetres(run.begun_m) + " on, found with certainty " +
                                 humanPercent(run.certainty)
                           : "") +
        "; recognised " + std::to_string(run.recognised) + " of " + std::to_string(run.images) + " images";
    supervisor_.finish(reason);
    publishState(stamp);
    server_.setSucceeded(endRun(true, reason), reason);
    return;
  }
  ++run.number;
  beginTraversal(std::min(overshoot_m, run.session->length()), run.travelled_m, stamp);
}

// --- what others see
// -------------------------------------------------------------------------------------------------

void RepeatNavigator::publishState(const ros::Time& stamp, const NavigationStep* step) {
  reporter_.state(stamp, supervisor_.status(), gate_.newest(), run_.get(), step);
}

void RepeatNavigator::acknowledge(const sensor_msgs::ImageConstPtr& image) {
  reporter_.processed(image->header, run_ != nullptr, gate_.newest());
}

}  // namespace perennial
