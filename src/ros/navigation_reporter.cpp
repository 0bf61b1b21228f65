#include "perennial/ros/navigation_reporter.h"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>

#include <opencv2/imgcodecs.hpp>

#include "perennial/core/matches_picture.h"
#include "perennial/ros/conversions.h"
#include "perennial_nav/Processed.h"

namespace perennial {
namespace {

constexpr char kNode[] = "repeat_navigator";
constexpr int kMostLines = 3;  // in the log, of each state in each traversal

}  // namespace

NavigationReporter::NavigationReporter(ros::NodeHandle nh, ros::NodeHandle private_nh)
    : transport_(nh),
      state_publisher_(nh.advertise<perennial_nav::NavigationState>("navigation_state", 100, true)),
      processed_publisher_(nh.advertise<perennial_nav::Processed>("processed", 100)),
      matches_publisher_(transport_.advertise("matches", 1)),
      diagnostics_(nh, private_nh),
      log_(kMostLines) {
  diagnostics_.setHardwareID("none");
  diagnostics_.add("navigation", [this](auto& status) { diagnose(status); });
}

void NavigationReporter::state(const ros::Time& stamp, const NavigationStatus& status,
                               const geometry_msgs::Twist& command, const RepeatRun* run,
                               const NavigationStep* step) {
  const std::string mode = nameOf(status.mode);
  if (mode != state_.state) {
    log(mode, status.reason);
  }
  state_ = {};
  state_.header.stamp = stamp;
  state_.state = mode;
  state_.reason = status.reason;
  state_.speed_factor = status.speed_factor;
  state_.command = command;
  if (run != nullptr) {
    state_.map = run->goal.map_name;
    state_.traversal = run->number;
    state_.distance_m = run->distance();
    state_.length_m = run->session ? run->session->length() : 0.0;
  }
  if (step != nullptr) {
    const RegistrationResult& result = step->registration.result;
    state_.has_displacement = static_cast<std::uint8_t>(result.displacement_px.has_value());
    state_.displacement_px = result.displacement_px.value_or(0.0);
    state_.inliers = result.inliers;
  }
  state_publisher_.publish(state_);
}

void NavigationReporter::log(const std::string& mode, const std::string& reason) {
  const NoteLimit::Verdict verdict = log_.note(mode);
  if (verdict != NoteLimit::Verdict::kKeepQuiet) {
    const bool last = verdict == NoteLimit::Verdict::kSayForTheLastTime;
    ROS_INFO("%s: %s%s", mode.c_str(), reason.c_str(),
             last ? " (navigation_state says it from now on in this traversal, not the log)" : "");
  }
}

void NavigationReporter::matches(const NavigationStep& step, const sensor_msgs::ImageConstPtr& image,
                                 const RepeatRun& run) {
  const auto entry = run.messages.find(step.local_map);
  if (matches_publisher_.getNumSubscribers() == 0 || entry == run.messages.end()) {
    return;
  }
  const perennial_nav::LocalMap& message = *entry->second;
  const cv::Mat map_image = cv::imdecode(message.image.data, cv::IMREAD_GRAYSCALE);
  const ActiveMap map = fromMessage(message);
  const cv::Mat picture =
      drawMatches(map_image, greyImage(image), map.alternatives[step.registration.alternative].features,
                  step.view, step.registration.result);
  matches_publisher_.publish(
      cv_bridge::CvImage(image->header, sensor_msgs::image_encodings::BGR8, picture).toImageMsg());
}

void NavigationReporter::processed(const std_msgs::Header& header, bool drives,
                                   const geometry_msgs::Twist& command) {
  perennial_nav::Processed processed;
  processed.header = header;
  processed.node = kNode;
  processed.has_command = static_cast<std::uint8_t>(drives);
  processed.command = command;
  processed_publisher_.publish(processed);
}

void NavigationReporter::update(std::size_t dropped_images, std::size_t ignored_maps, bool has_camera_info) {
  dropped_images_ = dropped_images;
  ignored_maps_ = ignored_maps;
  has_camera_info_ = has_camera_info;
  diagnostics_.update();
}

void NavigationReporter::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  using diagnostic_msgs::DiagnosticStatus;
  using perennial_nav::NavigationState;
  const std::string text = state_.state + ": " + state_.reason;
  if (state_.state == NavigationState::FAILED) {
    status.summary(DiagnosticStatus::ERROR, text);
  } else if (state_.state == NavigationState::STOPPED || state_.state == NavigationState::HOLDING ||
             state_.state == NavigationState::DEGRADED) {
    status.summary(DiagnosticStatus::WARN, text);
  } else {
    status.summary(DiagnosticStatus::OK, text);
  }
  status.add("state", state_.state);
  status.add("reason", state_.reason);
  status.add("speed factor", state_.speed_factor);
  status.add("map", state_.map.empty() ? "none" : state_.map);
  status.add("traversal", state_.traversal);
  status.add("distance_m", state_.distance_m);
  status.add("camera_info", has_camera_info_ ? "known" : "missing: the gain per pixel is used");
  status.add("images dropped", dropped_images_);
  status.add("stale local maps ignored", ignored_maps_);
}

}  // namespace perennial
