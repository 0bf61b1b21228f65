#include "perennial/ros/map_manager_node.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "perennial/core/error.h"
#include "perennial/core/map_name.h"
#include "perennial/ros/conversions.h"
#include "perennial/ros/parameters.h"

namespace perennial {
namespace {

/// How long end_traversal waits, in real time, for registrations that were published but have not come yet.
constexpr std::chrono::seconds kRegistrationWait(5);

}  // namespace

MapManagerNodeSettings MapManagerNodeSettings::load(ParameterReader& reader) {
  MapManagerNodeSettings settings;
  settings.map_folder = reader.text("map_folder", settings.map_folder);
  if (settings.map_folder.empty()) {
    throw ParameterError("parameter map_folder is missing: name the folder in which maps are stored");
  }
  settings.strategy = reader.text("strategy", settings.strategy);
  return settings;
}

MapManagerNode::MapManagerNode(ros::NodeHandle nh, ros::NodeHandle private_nh)
    : nh_(std::move(nh)),
      private_nh_(std::move(private_nh)),
      settings_(loadNode<MapManagerNodeSettings>(private_nh_, {"*"})),
      manager_settings_(loadGroup<MapManagerSettings>(private_nh_, "management")),
      strategy_(loader_.load(settings_.strategy)),
      diagnostics_(nh_, private_nh_),
      service_spinner_(1, &service_queue_) {
  std::vector<std::string> groups = loader_.names();
  groups.push_back("management");
  readParameters(private_nh_, groups);  // a misspelt group is an error
  ParameterReader reader = groupReader(private_nh_, settings_.strategy);
  strategy_->configure(reader);
  reader.requireAllUsed();

  map_publisher_ = nh_.advertise<perennial_nav::LocalMap>(
      "local_maps", 1000,
      [this](const ros::SingleSubscriberPublisher& subscriber) { onSubscriber(subscriber); });
  registration_subscriber_ = nh_.subscribe("registration", 1000, &MapManagerNode::onRegistration, this);
  diagnostics_.setHardwareID("none");
  diagnostics_.add("map", [this](auto& status) { diagnose(status); });
  diagnostics_timer_ =
      nh_.createTimer(ros::Duration(0.5), [this](const ros::TimerEvent&) { diagnostics_.update(); });

  ros::NodeHandle service_nh(nh_);
  service_nh.setCallbackQueue(&service_queue_);
  begin_server_ = service_nh.advertiseService("begin_traversal", &MapManagerNode::onBegin, this);
  end_server_ = service_nh.advertiseService("end_traversal", &MapManagerNode::onEnd, this);
  get_server_ = service_nh.advertiseService("get_local_maps", &MapManagerNode::onGet, this);
  service_spinner_.start();
}

MapManagerNode::~MapManagerNode() { service_spinner_.stop(); }

bool MapManagerNode::onBegin(perennial_nav::BeginTraversalRequest& request,
                             perennial_nav::BeginTraversalResponse& response) {
  const std::lock_guard<std::mutex> lock(mutex_);
  manager_.reset();
  try {
    open(request, response);
    response.success = true;
  } catch (const Error& error) {
    manager_.reset();
    response.message = error.what();
    ROS_ERROR("cannot begin a traversal of '%s': %s", request.map_name.c_str(), error.what());
  }
  return true;
}

void MapManagerNode::open(const perennial_nav::BeginTraversalRequest& request,
                          perennial_nav::BeginTraversalResponse& response) {
  manager_ = std::make_unique<MapManager>(MapFile(existingMapFile(settings_.map_folder, request.map_name)),
                                          strategy_, manager_settings_);
  beginTraversal(request.stamp.toSec());
  ++traversal_;
  registrations_ = 0;
  window_begin_ = window_end_ = 0;
  stamp_ = request.stamp;

  const MapMetadata& metadata = manager_->file().metadata();
  response.node = ros::this_node::getName();
  response.traversal = traversal_;
  response.camera = metadata.camera;
  response.image_width = static_cast<std::uint32_t>(metadata.image_width);
  response.image_height = static_cast<std::uint32_t>(metadata.image_height);
  response.image_encoding = metadata.image_encoding;
  response.extraction = metadata.extraction;
  response.length_m = metadata.length_m;
  response.local_maps = static_cast<std::uint32_t>(manager_->file().size());
  response.map_interval_m = metadata.map_interval_m;
  response.profile = toMessage(manager_->file().profile());
  publishDue(request.start_distance_m);
}

void MapManagerNode::beginTraversal(double stamp_s) {
  const std::uint32_t version = manager_->file().formatVersion();
  manager_->beginTraversal(stamp_s);
  const MapFile& file = manager_->file();
  if (file.formatVersion() != version) {
    ROS_INFO("map '%s' was migrated to format version %u; the original is kept as '%s'", file.file().c_str(),
             file.formatVersion(), keptMapFile(file.file(), version).c_str());
  }
  problem_ = manager_->cannotLearn();
  if (!problem_.empty()) {
    ROS_ERROR("this traversal will not be learned from: %s", problem_.c_str());
  }
}

void MapManagerNode::onSubscriber(const ros::SingleSubscriberPublisher& subscriber) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!manager_ || !manager_->inTraversal()) {
    return;
  }
  try {
    for (std::uint32_t index = window_begin_; index < window_end_; ++index) {
      subscriber.publish(message(index));
    }
  } catch (const Error& error) {
    ROS_ERROR("local maps cannot be read: %s", error.what());
  }
}

void MapManagerNode::publishDue(double distance_m) {
  for (const std::uint32_t index : manager_->due(distance_m)) {
    map_publisher_.publish(message(index));
    window_end_ = index + 1;
  }
  const std::uint32_t here = manager_->file().nearest(distance_m).index;
  window_begin_ = here == 0 ? 0 : here - 1;
}

bool MapManagerNode::onGet(perennial_nav::GetLocalMapsRequest& request,
                           perennial_nav::GetLocalMapsResponse& response) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!manager_ || !manager_->inTraversal() || request.traversal != traversal_) {
    response.message = "traversal " + std::to_string(request.traversal) + " is not open";
    return true;
  }
  const std::size_t most = std::min<std::size_t>(request.count, perennial_nav::GetLocalMapsRequest::MOST);
  const std::size_t end = std::min<std::size_t>(request.first + most, manager_->file().size());
  try {
    for (std::size_t index = request.first; index < end; ++index) {
      response.maps.push_back(
          messageWithoutImage(static_cast<std::uint32_t>(index), request.with_edges != 0));
    }
    response.success = static_cast<std::uint8_t>(true);
  } catch (const Error& error) {
    response.maps.clear();
    response.message = error.what();
    ROS_ERROR("local maps cannot be read: %s", error.what());
  }
  return true;
}

perennial_nav::LocalMap MapManagerNode::messageWithoutImage(std::uint32_t index, bool with_edges) const {
  perennial_nav::LocalMap message =
      toMessage(with_edges ? manager_->activeMap(index) : manager_->activeMapWithoutEdges(index));
  message.header.stamp = stamp_;
  message.traversal = traversal_;
  return message;
}

perennial_nav::LocalMap MapManagerNode::message(std::uint32_t index) const {
  perennial_nav::LocalMap message = messageWithoutImage(index, true);
  message.image.header.stamp = stamp_;
  message.image.format = "png";
  message.image.data = manager_->file().readImagePng(index);
  return message;
}

void MapManagerNode::onRegistration(const perennial_nav::RegistrationConstPtr& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!manager_ || !manager_->inTraversal() || message->traversal != traversal_) {
    return;
  }
  ++registrations_;
  try {
    publishDue(message->distance_m);
    if (problem_.empty()) {
      learn(*message);
    }
  } catch (const Error& error) {
    problem_ = error.what();
    ROS_ERROR("this traversal will not be learned from: %s", error.what());
  }
  registration_came_.notify_all();
}

void MapManagerNode::learn(const perennial_nav::Registration& message) {
  manager_->observe(message.local_map, message.local_map_distance_m, observationFromMessage(message));
}

bool MapManagerNode::onEnd(perennial_nav::EndTraversalRequest& request,
                           perennial_nav::EndTraversalResponse& response) {
  std::unique_lock<std::mutex> lock(mutex_);
  if (!manager_ || !manager_->inTraversal() || request.traversal != traversal_) {
    response.message = "traversal " + std::to_string(request.traversal) + " is not open";
    return true;
  }
  const bool complete = registration_came_.wait_for(lock, kRegistrationWait,
                                                    [&] { return registrations_ >= request.registrations; });
  if (!complete && problem_.empty()) {
    problem_ = "only " + std::to_string(registrations_) + " of " + std::to_string(request.registrations) +
               " registrations arrived";
  }
  try {
    const bool commit = static_cast<bool>(request.commit) && problem_.empty();
    response.updated_maps = static_cast<std::uint32_t>(manager_->endTraversal(commit, request.stamp.toSec()));
    response.success = problem_.empty();
    response.message = problem_;
  } catch (const Error& error) {
    problem_ = error.what();
    response.message = problem_;
    ROS_ERROR("what this traversal taught cannot be stored: %s", error.what());
  }
  return true;
}

void MapManagerNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!problem_.empty()) {
    status.summary(DiagnosticStatus::ERROR, problem_);
  } else {
    status.summary(DiagnosticStatus::OK, manager_ && manager_->inTraversal() ? "in a traversal" : "idle");
  }
  status.add("strategy", settings_.strategy);
  status.add("map", manager_ ? manager_->file().file() : "none");
  status.add("local maps", manager_ ? manager_->file().size() : 0);
  status.add("registrations of this traversal", registrations_);
}

}  // namespace perennial
