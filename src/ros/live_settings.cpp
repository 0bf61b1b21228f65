#include "perennial/ros/live_settings.h"

#include <utility>

#include "perennial/ros/reconfigure.h"

namespace perennial {

LiveSettings::LiveSettings(const ros::NodeHandle& private_nh, RepeatSettings& settings,
                           std::function<RepeatSession*()> session)
    : settings_(settings),
      session_(std::move(session)),
      extraction_(ros::NodeHandle(private_nh, "extraction")),
      registration_(ros::NodeHandle(private_nh, "registration")),
      steering_(ros::NodeHandle(private_nh, "steering")) {
  extraction_.setCallback([this](perennial_nav::ExtractionConfig& config, uint32_t level) {
    if (level == kFirstReconfigure || session_() != nullptr) {
      toConfig(settings_.extraction, config);
    } else {
      settings_.extraction = fromConfig(config);
    }
  });
  registration_.setCallback([this](perennial_nav::RegistrationConfig& config, uint32_t level) {
    if (level == kFirstReconfigure) {
      toConfig(settings_.registration, config);
      return;
    }
    settings_.registration = fromConfig(config);
    if (RepeatSession* session = session_()) {
      session->setRegistration(settings_.registration);
    }
  });
  steering_.setCallback([this](perennial_nav::SteeringConfig& config, uint32_t level) {
    if (level == kFirstReconfigure) {
      toConfig(settings_.steering, config);
      return;
    }
    settings_.steering = fromConfig(config);
    if (RepeatSession* session = session_()) {
      session->setSteering(settings_.steering);
    }
  });
}

}  // namespace perennial
