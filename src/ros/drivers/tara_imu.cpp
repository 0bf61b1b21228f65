#include "perennial/ros/drivers/tara_imu.h"

#include <chrono>
#include <utility>

namespace perennial {
namespace {

/// Three periods of the slowest rate.
constexpr std::chrono::milliseconds kSilence(200);

}  // namespace

TaraImu::TaraImu(const std::string& path, std::function<void(const TaraImuReading&)> callback)
    : hid_(path), callback_(std::move(callback)), thread_([this] { work(); }) {}

TaraImu::~TaraImu() {
  end_ = true;
  thread_.join();
}

void TaraImu::work() {
  bool one_report_per_request = false;
  int reports_since_request = 0;
  bool lost = !hid_.send(taraImuValuesRequest());
  TaraReply reply;
  while (!end_ && !lost) {
    const TaraHid::Outcome outcome = hid_.read(kSilence, reply);
    lost = outcome == TaraHid::Outcome::kLost;
    if (outcome == TaraHid::Outcome::kReply) {
      ++reports_since_request;
      const auto reading = decodeTaraImuValues(reply);
      if (reading) {
        callback_(*reading);
      } else {
        ++bad_reports_;
      }
    }
    const bool silent = outcome == TaraHid::Outcome::kTimeout;
    one_report_per_request = one_report_per_request || (silent && reports_since_request == 1);
    if (silent || one_report_per_request) {
      lost = lost || !hid_.send(taraImuValuesRequest());
      reports_since_request = 0;
    }
  }
}

}  // namespace perennial
