#include "perennial/ros/drivers/tara_simulated_hid.h"

#include <poll.h>
#include <pthread.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

namespace perennial {
namespace {

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

TaraSimulatedHid::TaraSimulatedHid(TaraWorld& world) : world_(world), thread_([this] { run(); }) {
  world_.exposure = device_.exposure();
  thread_.detach();
}

int TaraSimulatedHid::openControl() { return open(control_); }

int TaraSimulatedHid::openImu() { return open(imu_); }

int TaraSimulatedHid::open(std::atomic<int>& far_end) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, ends) != 0) {
    return -1;
  }
  const int last = far_end.exchange(ends[1]);
  if (last >= 0) {
    close(last);
  }
  return ends[0];
}

void TaraSimulatedHid::run() {
  pthread_setname_np(pthread_self(), "simulated_hid");  // not to be taken for the driver's
  while (true) {
    pollfd readable[2] = {{control_, POLLIN, 0}, {imu_, POLLIN, 0}};
    poll(readable, 2, 1);
    if (world_.unplugged != 0) {
      for (std::atomic<int>* end : {&control_, &imu_}) {
        const int last = end->exchange(-1);
        if (last >= 0) {
          close(last);
        }
      }
      device_ = TaraDevice();
      imu_asked_ = false;
      continue;
    }
    if ((readable[0].revents & POLLIN) != 0) {
      serve(control_, false);
    }
    if ((readable[1].revents & POLLIN) != 0) {
      serve(imu_, true);
    }
    streamImu();
  }
}

void TaraSimulatedHid::serve(std::atomic<int>& far_end, bool is_imu) {
  TaraRequest request{};
  const ssize_t size = recv(far_end, request.data(), request.size(), 0);
  if (size != static_cast<ssize_t>(request.size())) {
    const int last = far_end.exchange(-1);
    if (last >= 0) {
      close(last);
    }
    return;
  }
  if (is_imu) {
    imu_asked_ = true;
    return;
  }
  const TaraReply answer = device_.answer(request);
  world_.exposure = device_.exposure();
  reply(far_end, answer);
}

void TaraSimulatedHid::streamImu() {
  const double rate = taraImuRate(device_.imuSetup().rate);
  const double now = now_s();
  if (imu_ < 0 || !imu_asked_ || !device_.imuStreams() || rate <= 0.0) {
    next_report_s_ = now;
    return;
  }
  for (; next_report_s_ <= now; next_report_s_ += 1.0 / rate) {
    reply(imu_, TaraDevice::imuReport(device_.imuReading()));
  }
}

void TaraSimulatedHid::reply(int far_end, TaraReply report) {
  if (world_.hid_silent != 0) {
    return;
  }
  if (world_.hid_nonsense != 0) {
    std::generate(report.begin(), report.end(), [this] { return static_cast<std::uint8_t>(random_()); });
  }
  send(far_end, report.data(), report.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

}  // namespace perennial
