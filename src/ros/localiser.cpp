#include "perennial/ros/localiser.h"

#include <utility>

#include "perennial/core/error.h"
#include "perennial_nav/GetLocalMaps.h"

namespace perennial {
namespace {

/// Local maps compared at once: some 20 ms.
constexpr std::size_t kPiece = 100;
static_assert(kPiece <= perennial_nav::GetLocalMapsRequest::MOST, "more than the manager gives at once");
/// Others hear of it every so many local maps.
constexpr std::size_t kReport = 500;
/// Between two pieces.
const ros::WallDuration kPause(0.001);

}  // namespace

Localiser::Localiser(const ros::NodeHandle& nh, TraversalClient& traversals, Events events)
    : traversals_(traversals), events_(std::move(events)) {
  timer_ = nh.createWallTimer(
      kPause, [this](const ros::WallTimerEvent&) { onTimer(); }, false, false);
}

void Localiser::begin(const LocalisationSettings& settings, const RegistrationSettings& registration,
                      std::size_t local_maps) {
  end();
  localisation_ = std::make_unique<Localisation>(settings, registration, local_maps);
}

void Localiser::end() {
  timer_.stop();
  image_.reset();
  localisation_.reset();
}

void Localiser::look(const sensor_msgs::ImageConstPtr& image, FeatureSet view, double travelled_m) {
  localisation_->look(std::move(view), travelled_m);
  image_ = image;
  travelled_m_ = travelled_m;
  begun_ = ros::WallTime::now();
  timer_.start();
  events_.progressed();
}

/// What an event does may end the search, and so each is the last that is done here.
void Localiser::onTimer() {
  if (!searching()) {
    return;  // it was on its way when the search ended
  }
  try {
    compareSome();
  } catch (const Error& error) {
    events_.failed(error.what());
    return;
  }
  if (localisation_->complete()) {
    timer_.stop();
    const std::optional<PlaceGuess> place = localisation_->conclude();
    ROS_INFO("an image was compared with %zu local maps in %.3f s", localisation_->next(),
             (ros::WallTime::now() - begun_).toSec());
    events_.concluded(std::exchange(image_, nullptr), place);
  } else if (localisation_->next() % kReport == 0) {
    events_.progressed();
  }
}

void Localiser::compareSome() {
  if (localisation_->considerKept(kPiece) > 0) {
    return;
  }
  std::vector<ActiveMap> maps = traversals_.localMaps(localisation_->next(), kPiece, false);
  if (maps.empty()) {
    throw MapError("map_manager has fewer local maps than it said");
  }
  for (ActiveMap& map : maps) {
    localisation_->consider(std::move(map));
  }
}

}  // namespace perennial
