#include "perennial/ros/drivers/tara_control.h"

#include <chrono>
#include <utility>

namespace perennial {
namespace {

constexpr std::chrono::milliseconds kReplyTimeout(2000);
constexpr std::chrono::milliseconds kRetryPause(1000);

}  // namespace

TaraControl::TaraControl(const std::string& path) : hid_(path), thread_([this] { work(); }) {}

TaraControl::~TaraControl() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    end_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void TaraControl::setExposure(std::uint32_t exposure) {
  const std::lock_guard<std::mutex> lock(mutex_);
  wanted_exposure_ = exposure;
  changed_.notify_all();
}

void TaraControl::setImu(const TaraImuSetup& setup) {
  const std::lock_guard<std::mutex> lock(mutex_);
  wanted_imu_ = setup;
  changed_.notify_all();
}

TaraControl::State TaraControl::state() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return state_;
}

void TaraControl::work() {
  identify();
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return end_ || wanted_exposure_ || wanted_imu_; });
    if (end_) {
      return;
    }
    const auto exposure = std::exchange(wanted_exposure_, std::nullopt);
    const auto imu = std::exchange(wanted_imu_, std::nullopt);
    lock.unlock();
    const bool exposed = !exposure || applyExposure(*exposure);
    const bool measuring = !imu || applyImu(*imu);
    lock.lock();
    if (exposed && measuring) {
      continue;
    }
    // What the camera has not confirmed is asked for again, unless something newer is wanted by now.
    wanted_exposure_ = exposed || wanted_exposure_ ? wanted_exposure_ : exposure;
    wanted_imu_ = measuring || wanted_imu_ ? wanted_imu_ : imu;
    changed_.wait_for(lock, kRetryPause, [this] { return end_; });
  }
}

void TaraControl::identify() {
  const auto firmware = ask(taraFirmwareRequest());
  const auto unique_id = ask(taraUniqueIdRequest());
  const std::lock_guard<std::mutex> lock(mutex_);
  state_.firmware = firmware ? decodeTaraFirmware(*firmware) : std::nullopt;
  state_.unique_id = unique_id ? decodeTaraUniqueId(*unique_id) : std::nullopt;
}

bool TaraControl::applyExposure(std::uint32_t exposure) {
  const auto reply = ask(taraSetExposureRequest(exposure));
  const bool done = reply && decodeTaraExposureSet(*reply);
  const std::lock_guard<std::mutex> lock(mutex_);
  state_.exposure = done ? std::optional<std::uint32_t>(exposure) : state_.exposure;
  state_.failures += reply && !done ? 1 : 0;
  return done;
}

bool TaraControl::applyImu(const TaraImuSetup& setup) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    state_.imu.reset();
  }
  const auto set = ask(taraSetImuSetupRequest(setup));
  const auto stream = ask(taraImuStreamRequest(setup.mode != TaraImuMode::kOff));
  const bool done = set && decodeTaraImuSetupSet(*set) && stream && decodeTaraImuStream(*stream);
  const std::lock_guard<std::mutex> lock(mutex_);
  state_.imu = done ? std::optional<TaraImuSetup>(setup) : std::nullopt;
  state_.imu_since = std::chrono::steady_clock::now();
  state_.failures += set && stream && !done ? 1 : 0;
  return done;
}

std::optional<TaraReply> TaraControl::ask(const TaraRequest& request) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (end_) {
      return std::nullopt;
    }
  }
  auto reply = hid_.ask(request, kReplyTimeout);
  if (!reply) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++state_.failures;
  }
  return reply;
}

}  // namespace perennial
