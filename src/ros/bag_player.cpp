#include "perennial/ros/bag_player.h"

#include <actionlib/client/simple_action_client.h>
#include <rosbag/view.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/Image.h>
#include <topic_tools/shape_shifter.h>

#include <algorithm>
#include <utility>

#include "perennial/core/error.h"
#include "perennial/ros/parameters.h"
#include "perennial_nav/RepeatAction.h"
#include "perennial_nav/TeachAction.h"

namespace perennial {
namespace {

using TeachClient = actionlib::SimpleActionClient<perennial_nav::TeachAction>;
using RepeatClient = actionlib::SimpleActionClient<perennial_nav::RepeatAction>;

/// So many images may be on their way: enough to keep the nodes busy, and for odometry that comes after its
/// image.
constexpr std::size_t kUnanswered = 4;
const ros::WallDuration kClockInterval(0.1);
/// Never a topic that a robot's driver listens to.
constexpr const char* kCommandsOfBag = "bag/cmd_vel";

/// Whatever its name: there may be a robot on this master.
bool movesRobots(const rosbag::ConnectionInfo& connection) {
  return connection.datatype == "geometry_msgs/Twist" || connection.datatype == "geometry_msgs/TwistStamped";
}

}  // namespace

BagPlayerSettings BagPlayerSettings::load(ParameterReader& reader) {
  BagPlayerSettings settings;
  settings.bag = reader.text("bag", settings.bag);
  settings.mode = reader.choice("mode", settings.mode, {"teach", "repeat"});
  settings.map_name = reader.text("map_name", settings.map_name);
  settings.overwrite = reader.boolean("overwrite", settings.overwrite);
  settings.start_distance_m = reader.real("start_distance_m", settings.start_distance_m, 0.0, 1e7);
  settings.localise = reader.boolean("localise", settings.localise);
  settings.image_topic = reader.text("image_topic", settings.image_topic);
  settings.odom_topic = reader.text("odom_topic", settings.odom_topic);
  settings.command_topic = reader.text("command_topic", settings.command_topic);
  settings.patience_s = reader.real("patience_s", settings.patience_s, 0.1, 3600.0);
  if (settings.bag.empty() || settings.map_name.empty()) {
    throw ParameterError("the parameters bag and map_name are needed");
  }
  return settings;
}

BagPlayer::BagPlayer(ros::NodeHandle nh, ros::NodeHandle private_nh)
    : nh_(std::move(nh)),
      settings_(loadNode<BagPlayerSettings>(private_nh, {"evaluation"})),
      node_(settings_.mode == "teach" ? "teach_recorder" : "repeat_navigator") {
  try {
    bag_.open(settings_.bag, rosbag::bagmode::Read);
  } catch (const rosbag::BagException& error) {
    throw Error(
        "bag " + settings_.bag + " cannot be read: " + error.what() +
        (settings_.bag.front() == '/' ? "" : " (nodes run in another folder: give an absolute path)"));
  }
  requireTopics();
  clock_publisher_ = nh_.advertise<rosgraph_msgs::Clock>("/clock", 100);
  processed_subscriber_ = nh_.subscribe("processed", 1000, &BagPlayer::onProcessed, this);
  advertise();
}

void BagPlayer::requireTopics() const {
  std::set<std::string> topics;
  for (const rosbag::ConnectionInfo* connection : rosbag::View(bag_).getConnections()) {
    topics.insert(connection->topic);
  }
  std::string known;
  for (const std::string& topic : topics) {
    known += (known.empty() ? "" : ", ") + topic;
  }
  for (const std::string& topic : {settings_.image_topic, settings_.odom_topic}) {
    if (topics.count(topic) == 0) {
      throw Error("bag " + settings_.bag + " has no topic " + topic + "; it has: " + known);
    }
  }
}

void BagPlayer::advertise() {
  for (const rosbag::ConnectionInfo* connection : rosbag::View(bag_).getConnections()) {
    const std::string& topic = connection->topic;
    const bool commands = topic == settings_.command_topic;
    const bool kept_back =
        topic == "/clock" || (commands ? settings_.mode == "repeat" : movesRobots(*connection));
    if (kept_back || publishers_.count(topic) > 0) {
      continue;
    }
    const std::string published = commands ? kCommandsOfBag : topic;
    ros::AdvertiseOptions options(published, 0, connection->md5sum, connection->datatype,
                                  connection->msg_def);
    publishers_[topic] = nh_.advertise(options);
  }
}

bool BagPlayer::run() {
  publishClock(rosbag::View(bag_).getBeginTime());
  return settings_.mode == "teach" ? teach() : repeat();
}

bool BagPlayer::teach() {
  TeachClient client(nh_, "teach", false);
  if (!waitUntil([&] { return client.isServerConnected(); }, settings_.patience_s)) {
    throw Error("teach_recorder does not answer");
  }
  perennial_nav::TeachGoal goal;
  goal.map_name = settings_.map_name;
  goal.overwrite = static_cast<std::uint8_t>(settings_.overwrite);
  client.sendGoal(goal);
  awaitStart([&] { return client.getState() != actionlib::SimpleClientGoalState::PENDING; });
  play([&] { return client.getState().isDone(); });
  client.cancelGoal();  // finishes the map
  if (!waitUntil([&] { return client.getState().isDone(); }, settings_.patience_s)) {
    throw Error("teach_recorder does not finish the map");
  }
  const auto result = client.getResult();
  return ended(result->success != 0, result->message);
}

bool BagPlayer::repeat() {
  RepeatClient client(nh_, "repeat", false);
  if (!waitUntil([&] { return client.isServerConnected(); }, settings_.patience_s)) {
    throw Error("repeat_navigator does not answer");
  }
  perennial_nav::RepeatGoal goal;
  goal.map_name = settings_.map_name;
  goal.traversals = 1;
  goal.start_distance_m = settings_.start_distance_m;
  goal.localise = static_cast<std::uint8_t>(settings_.localise);
  client.sendGoal(goal);
  awaitStart([&] { return client.getState() != actionlib::SimpleClientGoalState::PENDING; });
  play([&] { return client.getState().isDone(); });
  if (!client.getState().isDone()) {
    ROS_WARN("the bag ends before the path does");
    client.cancelGoal();
  }
  if (!waitUntil([&] { return client.getState().isDone(); }, settings_.patience_s)) {
    throw Error("repeat_navigator does not end");
  }
  const auto result = client.getResult();
  return ended(result->success != 0, result->reason);
}

bool BagPlayer::ended(bool success, const std::string& message) const {
  ROS_LOG(success ? ros::console::levels::Info : ros::console::levels::Error, ROSCONSOLE_DEFAULT_NAME,
          "%zu images played: %s", images_, message.c_str());
  return success;
}

void BagPlayer::awaitStart(const std::function<bool()>& started) {
  if (!waitUntil(started, settings_.patience_s)) {
    throw Error(node_ + " does not take up the goal");
  }
}

void BagPlayer::play(const std::function<bool()>& stop) {
  for (const std::string& topic : {settings_.image_topic, settings_.odom_topic}) {
    if (!waitUntil([&] { return stop() || publishers_.at(topic).getNumSubscribers() > 0; },
                   settings_.patience_s)) {
      throw Error("nobody subscribes to " + topic + "; do the launch file's topics agree with the bag's?");
    }
  }
  rosbag::View view(bag_);
  for (const rosbag::MessageInstance& message : view) {
    const auto publisher = publishers_.find(message.getTopic());
    if (publisher == publishers_.end()) {
      continue;
    }
    publishClock(message.getTime());
    if (message.getTopic() == settings_.image_topic) {
      const sensor_msgs::ImageConstPtr image = message.instantiate<sensor_msgs::Image>();
      if (!image) {
        throw Error(
            settings_.image_topic + " of the bag holds " + message.getDataType() +
            ", not sensor_msgs/Image; compressed images must be unpacked (image_transport republish) first");
      }
      unanswered_.insert(image->header.stamp);
      ++images_;
    }
    publisher->second.publish(message.instantiate<topic_tools::ShapeShifter>());
    if (!waitUntil([&] { return stop() || unanswered_.size() < kUnanswered; }, settings_.patience_s)) {
      throw Error(node_ + " has not processed the image of " + std::to_string(unanswered_.begin()->toSec()) +
                  " s; is there odometry for it, and does it run with every_image?");
    }
    if (stop() || !ros::ok()) {
      return;
    }
  }
  // The last images may lack odometry after them; nothing more comes.
  waitUntil([&] { return stop() || unanswered_.empty(); }, 3.0);
}

void BagPlayer::publishClock(const ros::Time& time) {
  if (time < clock_) {
    return;
  }
  clock_ = time;
  rosgraph_msgs::Clock message;
  message.clock = time;
  clock_publisher_.publish(message);
}

bool BagPlayer::waitUntil(const std::function<bool()>& done, double seconds) {
  const ros::WallTime begin = ros::WallTime::now();
  const ros::WallTime deadline = begin + ros::WallDuration(seconds);
  ros::WallTime next_clock = begin + kClockInterval;
  while (ros::ok() && !done()) {
    const ros::WallTime now = ros::WallTime::now();
    if (now > deadline) {
      return false;
    }
    if (now > next_clock) {
      publishClock(clock_);  // for nodes that have just come up
      next_clock = now + kClockInterval;
    }
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
  }
  return true;
}

void BagPlayer::onProcessed(const perennial_nav::Processed& message) {
  if (message.node == node_) {
    unanswered_.erase(message.header.stamp);
    if (message.has_command) {
      newest_answered_ = std::max(newest_answered_, message.header.stamp);
    }
  }
}

}  // namespace perennial
