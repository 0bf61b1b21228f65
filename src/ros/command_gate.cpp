#include "perennial/ros/command_gate.h"

#include <algorithm>
#include <chrono>

#include "perennial/ros/conversions.h"

namespace perennial {
namespace {

const ros::Duration kWatchPeriod(0.05);
/// A pause between commands longer than this is no time to have accelerated in.
constexpr double kLongestStep_s = 0.25;
constexpr std::chrono::milliseconds kMasterTimeout(3000);

ros::NodeHandle withQueue(ros::NodeHandle nh, ros::CallbackQueue& queue) {
  nh.setCallbackQueue(&queue);
  return nh;
}

}  // namespace

CommandGate::CommandGate(ros::NodeHandle nh, double timeout_s, const VelocityLimits& limits,
                         const InterlockSettings& interlock)
    : timeout_(timeout_s),
      limits_(limits),
      nh_(withQueue(nh, queue_)),
      interlock_(interlock),
      master_(kMasterTimeout),
      spinner_(1, &queue_) {
  publisher_ = nh_.advertise<geometry_msgs::Twist>("cmd_vel", 10);
  subscriber_ = nh_.subscribe("cmd_vel", 100, &CommandGate::onCommand, this);
  timer_ = nh_.createTimer(kWatchPeriod, [this](const ros::TimerEvent&) { watch(); });
  spinner_.start();
}

CommandGate::~CommandGate() {
  spinner_.stop();
  if (driving_ || by_hand_) {
    send({});
  }
}

void CommandGate::begin() {
  const std::lock_guard<std::mutex> lock(mutex_);
  interlock_.forgetCommands();
}

bool CommandGate::fresh(const ros::Time& now) const {
  return now - stamp_ <= timeout_ && stamp_ - now <= timeout_;
}

bool CommandGate::drive(const Velocity& velocity, const ros::Time& stamp) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double elapsed_s = driving_ ? (stamp - stamp_).toSec() : kWatchPeriod.toSec();
  driving_ = true;
  stamp_ = stamp;
  const ros::Time now = ros::Time::now();
  const MotionPermit permit = interlock_.at(now.toSec());
  if (permit.kind == MotionPermit::Kind::kManual) {
    return fresh(now);  // the watching thread sends what the person wants
  }
  if (!fresh(now) || permit.kind == MotionPermit::Kind::kStop) {
    send({});
    return fresh(now);
  }
  if (permit.kind == MotionPermit::Kind::kHold) {
    hold(now);
  } else {
    approachAndSend(velocity, elapsed_s);
  }
  return true;
}

void CommandGate::halt() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (driving_ && !by_hand_) {
    send({});
  }
}

void CommandGate::stop() {
  const std::lock_guard<std::mutex> lock(mutex_);
  driving_ = false;
  send({});
}

geometry_msgs::Twist CommandGate::newest() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return newest_;
}

MotionPermit CommandGate::permit() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return interlock_.at(ros::Time::now().toSec());
}

template <typename Change>
void CommandGate::change(const Change& apply) {
  const std::lock_guard<std::mutex> lock(mutex_);
  apply();
  if (interlock_.at(ros::Time::now().toSec()).kind == MotionPermit::Kind::kStop) {
    enforce();
  }
}

void CommandGate::setEmergencyStop(EmergencyStop source, bool engaged) {
  change([&] { interlock_.setEmergencyStop(source, engaged); });
}

void CommandGate::latchEmergencyStop() {
  change([&] { interlock_.latchEmergencyStop(); });
}

bool CommandGate::emergencyStopped() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return interlock_.emergencyStopped();
}

bool CommandGate::resume() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return interlock_.resume();
}

void CommandGate::deadMan(bool held, const ros::Time& stamp) {
  change([&] { interlock_.deadMan(held, stamp.toSec(), ros::Time::now().toSec()); });
}

void CommandGate::obstacle(ObstacleSensor sensor, double distance_m, const ros::Time& stamp) {
  change([&] { interlock_.obstacle(sensor, distance_m, stamp.toSec(), ros::Time::now().toSec()); });
}

void CommandGate::teleop(const Velocity& velocity) {
  change([&] { interlock_.teleop(velocity, ros::Time::now().toSec()); });
}

void CommandGate::onCommand(const ros::MessageEvent<const geometry_msgs::Twist>& event) {
  if (event.getPublisherName() != ros::this_node::getName()) {
    change([&] { interlock_.strangerCommanded(event.getPublisherName(), ros::Time::now().toSec()); });
  }
}

void CommandGate::watch() {
  const bool master_alive = master_.alive();
  const std::lock_guard<std::mutex> lock(mutex_);
  interlock_.setMasterAlive(master_alive);
  enforce();
}

void CommandGate::enforce() {
  const ros::Time now = ros::Time::now();
  const MotionPermit permit = interlock_.at(now.toSec());
  if (permit.kind == MotionPermit::Kind::kManual) {
    by_hand_ = true;
    approachAndSend(permit.manual, kWatchPeriod.toSec());
    return;
  }
  const bool was_by_hand = by_hand_;
  by_hand_ = false;
  if (was_by_hand || (driving_ && (!fresh(now) || permit.kind == MotionPermit::Kind::kStop))) {
    send({});
  } else if (driving_ && permit.kind == MotionPermit::Kind::kHold && velocity_ != Velocity{}) {
    hold(now);
  }
}

void CommandGate::hold(const ros::Time& now) { approachAndSend({}, (now - sent_).toSec()); }

void CommandGate::approachAndSend(const Velocity& wanted, double elapsed_s) {
  send(approach(velocity_, wanted, std::clamp(elapsed_s, 0.0, kLongestStep_s), limits_));
}

void CommandGate::send(const Velocity& velocity) {
  velocity_ = velocity;
  sent_ = ros::Time::now();
  newest_ = toMessage(velocity);
  publisher_.publish(newest_);
}

}  // namespace perennial
