#include "perennial/ros/drivers/tara_simulated_video.h"

#include <linux/videodev2.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>

#include "perennial/core/drivers/tara_hid_codec.h"
#include "perennial/core/drivers/tara_y16.h"

namespace perennial {
namespace {

constexpr std::uint32_t kPage = 4096;
constexpr std::chrono::microseconds kPoll(500);

timeval monotonicNow() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return {now.tv_sec, now.tv_nsec / 1000};
}

}  // namespace

TaraSimulatedVideo::TaraSimulatedVideo(TaraWorld& world)
    : world_(world),
      event_(eventfd(0, EFD_SEMAPHORE | EFD_NONBLOCK | EFD_CLOEXEC)),
      memory_(memfd_create("tara", MFD_CLOEXEC)),
      buffer_size_((frameSize() + kPage - 1) / kPage * kPage) {
  const std::size_t size = kBuffers * buffer_size_;
  void* memory = MAP_FAILED;
  if (ftruncate(memory_, static_cast<off_t>(size)) == 0) {
    memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, memory_, 0);
  }
  buffers_ = memory == MAP_FAILED ? nullptr : static_cast<std::uint8_t*>(memory);
  thread_ = std::thread([this] { run(); });
}

TaraSimulatedVideo::~TaraSimulatedVideo() {
  end_ = true;
  thread_.join();
  munmap(buffers_, kBuffers * buffer_size_);
  close(memory_);
}

int TaraSimulatedVideo::control(unsigned long request, void* argument) {
  if (world_.unplugged != 0) {
    errno = ENODEV;
    return -1;
  }
  switch (request) {
    case VIDIOC_QUERYCAP:
      return describe(argument);
    case VIDIOC_S_FMT:
    case VIDIOC_G_FMT:
    case VIDIOC_TRY_FMT:
      return setFormat(argument);
    case VIDIOC_S_PARM:
      return setRate(argument);
    case VIDIOC_REQBUFS:
      static_cast<v4l2_requestbuffers*>(argument)->count = buffers_ == nullptr ? 0 : kBuffers;
      return 0;
    case VIDIOC_QUERYBUF:
      return queryBuffer(argument);
    case VIDIOC_QBUF:
      return queue(argument);
    case VIDIOC_DQBUF:
      return dequeue(argument);
    case VIDIOC_STREAMON:
      streaming_ = true;
      return 0;
    case VIDIOC_STREAMOFF:
      streaming_ = false;
      return 0;
    case VIDIOC_S_CTRL:
      return setControl(argument);
    default:
      errno = ENOTTY;
      return -1;
  }
}

int TaraSimulatedVideo::describe(void* argument) const {
  auto& capability = *static_cast<v4l2_capability*>(argument);
  capability = v4l2_capability{};
  std::strcpy(reinterpret_cast<char*>(capability.driver), "uvcvideo");
  std::strcpy(reinterpret_cast<char*>(capability.card), "See3CAM_Stereo");
  capability.capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  capability.device_caps = capability.capabilities;
  return 0;
}

int TaraSimulatedVideo::setFormat(void* argument) const {
  v4l2_pix_format& format = static_cast<v4l2_format*>(argument)->fmt.pix;
  format.width = world_.width;
  format.height = world_.height;
  format.pixelformat = V4L2_PIX_FMT_Y16;
  format.field = V4L2_FIELD_NONE;
  format.bytesperline = 2 * world_.width;
  format.sizeimage = frameSize();
  return 0;
}

int TaraSimulatedVideo::setRate(void* argument) {
  const v4l2_fract& period = static_cast<v4l2_streamparm*>(argument)->parm.capture.timeperframe;
  if (period.denominator > 0) {
    period_us_ = std::int64_t{1000000} * period.numerator / period.denominator;
  }
  return 0;
}

int TaraSimulatedVideo::queryBuffer(void* argument) const {
  auto& buffer = *static_cast<v4l2_buffer*>(argument);
  buffer.length = buffer_size_;
  buffer.m.offset = buffer.index * buffer_size_;
  return 0;
}

int TaraSimulatedVideo::queue(void* argument) {
  const std::lock_guard<std::mutex> lock(mutex_);
  queued_.push_back(static_cast<v4l2_buffer*>(argument)->index);
  return 0;
}

int TaraSimulatedVideo::dequeue(void* argument) {
  const std::lock_guard<std::mutex> lock(mutex_);
  eventfd_t one = 0;
  if (filled_.empty() || eventfd_read(event_, &one) != 0) {
    errno = EAGAIN;
    return -1;
  }
  const Filled filled = filled_.front();
  filled_.pop_front();
  auto& buffer = *static_cast<v4l2_buffer*>(argument);
  buffer.index = filled.index;
  buffer.bytesused = filled.size;
  buffer.sequence = filled.sequence;
  buffer.timestamp = filled.stamp;
  buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  return 0;
}

int TaraSimulatedVideo::setControl(void* argument) {
  const auto& wanted = *static_cast<v4l2_control*>(argument);
  if (wanted.id != V4L2_CID_BRIGHTNESS || wanted.value < 1 || wanted.value > 7) {
    errno = EINVAL;
    return -1;
  }
  world_.brightness = static_cast<std::uint32_t>(wanted.value);
  return 0;
}

void TaraSimulatedVideo::run() {
  std::uint64_t shown = world_.picture_number;
  pthread_setname_np(pthread_self(), "simulated_video");  // not to be taken for the driver's
  auto due = std::chrono::steady_clock::now();
  while (!end_) {
    if (world_.triggered != 0) {
      if (!waitForPicture(shown)) {
        continue;
      }
    } else {
      due = std::max(due + std::chrono::microseconds(period_us_), std::chrono::steady_clock::now());
      std::this_thread::sleep_until(due);
    }
    if (world_.unplugged != 0) {
      eventfd_write(event_, 1);  // whoever waits shall ask, and hear that the device is gone
    } else if (streaming_ && world_.stalled == 0) {
      fill();
    }
  }
}

/// Waits a little for a picture that was not shown yet.
bool TaraSimulatedVideo::waitForPicture(std::uint64_t& shown) const {
  const std::uint64_t newest = world_.picture_number;
  if (newest == shown) {
    std::this_thread::sleep_for(kPoll);
    return world_.unplugged != 0;
  }
  shown = newest;
  return true;
}

void TaraSimulatedVideo::fill() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++sequence_;
  if (queued_.empty()) {
    return;  // the driver is too slow: this frame is lost
  }
  const std::uint32_t index = queued_.front();
  queued_.pop_front();
  const TaraWorld::Picture& picture = world_.pictures[world_.picture_number % 2];
  std::uint8_t* words = buffers_ + static_cast<std::size_t>(index) * buffer_size_;
  mergeY16(picture.left, picture.right, frameSize() / 2, words);
  const std::uint32_t exposure = world_.exposure;
  if (exposure != kTaraAutomaticExposure && exposure != kTaraDefaultExposure) {
    for (std::uint32_t i = 0; i < frameSize(); ++i) {
      const std::uint64_t brighter = static_cast<std::uint64_t>(words[i]) * exposure / kTaraDefaultExposure;
      words[i] = static_cast<std::uint8_t>(std::min<std::uint64_t>(255, brighter));
    }
  }
  std::uint32_t size = frameSize();
  if (world_.short_frames > 0) {
    --world_.short_frames;
    size /= 3;
  }
  filled_.push_back({index, size, sequence_, monotonicNow()});
  ++world_.frames;
  eventfd_write(event_, 1);
}

}  // namespace perennial
