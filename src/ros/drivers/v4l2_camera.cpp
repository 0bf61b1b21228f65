#include "perennial/ros/drivers/v4l2_camera.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/select.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <ctime>

#include "perennial/core/error.h"

namespace perennial {
namespace {

constexpr std::uint32_t kBuffers = 4;

/// ioctl that goes on after signals.
template <typename Argument>
int control(int descriptor, unsigned long request, Argument* argument) {
  int result = 0;
  do {
    result = ioctl(descriptor, request, argument);
  } while (result == -1 && errno == EINTR);
  return result;
}

[[noreturn]] void fail(const std::string& path, const std::string& step) {
  throw Error(path + ": " + step + ": " + std::strerror(errno));
}

double ageOf(const v4l2_buffer& buffer) {
  if ((buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC) {
    return 0.0;
  }
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  const double age = static_cast<double>(now.tv_sec - buffer.timestamp.tv_sec) +
                     1e-9 * static_cast<double>(now.tv_nsec) -
                     1e-6 * static_cast<double>(buffer.timestamp.tv_usec);
  return std::max(age, 0.0);
}

v4l2_buffer emptyBuffer(std::uint32_t index) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

}  // namespace

V4l2Camera::V4l2Camera(const std::string& path, const Format& format) : path_(path) {
  descriptor_ = open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (descriptor_ < 0) {
    fail(path_, "open");
  }
  try {
    configure(format);
    mapBuffers();
    startStream();
  } catch (...) {
    release();
    throw;
  }
}

V4l2Camera::~V4l2Camera() {
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  control(descriptor_, VIDIOC_STREAMOFF, &type);
  release();
}

void V4l2Camera::configure(const Format& format) {
  v4l2_format wanted{};
  wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  wanted.fmt.pix.width = static_cast<std::uint32_t>(format.width);
  wanted.fmt.pix.height = static_cast<std::uint32_t>(format.height);
  wanted.fmt.pix.pixelformat = V4L2_PIX_FMT_Y16;
  wanted.fmt.pix.field = V4L2_FIELD_NONE;
  if (control(descriptor_, VIDIOC_S_FMT, &wanted) != 0) {
    fail(path_, "set format");
  }
  const v4l2_pix_format& got = wanted.fmt.pix;
  if (got.pixelformat != V4L2_PIX_FMT_Y16 || got.width != static_cast<std::uint32_t>(format.width) ||
      got.height != static_cast<std::uint32_t>(format.height) ||
      (got.bytesperline != 0 && got.bytesperline != 2 * got.width)) {
    throw Error(path_ + " does not stream Y16 at " + std::to_string(format.width) + "x" +
                std::to_string(format.height));
  }
  frame_size_ = static_cast<std::size_t>(2 * format.width * format.height);
  v4l2_streamparm rate{};
  rate.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  rate.parm.capture.timeperframe = {1000,
                                    static_cast<std::uint32_t>(std::lround(1000.0 * format.frame_rate))};
  if (control(descriptor_, VIDIOC_S_PARM, &rate) == 0 && rate.parm.capture.timeperframe.numerator > 0) {
    frame_rate_ = static_cast<double>(rate.parm.capture.timeperframe.denominator) /
                  static_cast<double>(rate.parm.capture.timeperframe.numerator);
  }
}

void V4l2Camera::mapBuffers() {
  v4l2_requestbuffers request{};
  request.count = kBuffers;
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  if (control(descriptor_, VIDIOC_REQBUFS, &request) != 0 || request.count < 2) {
    fail(path_, "request buffers");
  }
  for (std::uint32_t index = 0; index < request.count; ++index) {
    v4l2_buffer buffer = emptyBuffer(index);
    if (control(descriptor_, VIDIOC_QUERYBUF, &buffer) != 0) {
      fail(path_, "query buffer");
    }
    void* memory = mmap(nullptr, buffer.length, PROT_READ, MAP_SHARED, descriptor_, buffer.m.offset);
    if (memory == MAP_FAILED) {
      fail(path_, "map buffer");
    }
    buffers_.push_back({memory, buffer.length});
  }
}

void V4l2Camera::startStream() {
  for (std::uint32_t index = 0; index < buffers_.size(); ++index) {
    v4l2_buffer buffer = emptyBuffer(index);
    if (control(descriptor_, VIDIOC_QBUF, &buffer) != 0) {
      fail(path_, "queue buffer");
    }
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (control(descriptor_, VIDIOC_STREAMON, &type) != 0) {
    fail(path_, "start stream");
  }
}

void V4l2Camera::release() {
  for (const Buffer& buffer : buffers_) {
    munmap(buffer.memory, buffer.size);
  }
  buffers_.clear();
  close(descriptor_);
}

V4l2Camera::Outcome V4l2Camera::grab(double timeout_s, const std::function<void(const Frame&)>& callback) {
  fd_set readable;
  FD_ZERO(&readable);
  FD_SET(descriptor_, &readable);
  timeval timeout{static_cast<time_t>(timeout_s),
                  static_cast<suseconds_t>(1e6 * (timeout_s - std::floor(timeout_s)))};
  const int ready = select(descriptor_ + 1, &readable, nullptr, nullptr, &timeout);
  if (ready == 0 || (ready < 0 && errno == EINTR)) {
    return Outcome::kTimeout;
  }
  v4l2_buffer buffer = emptyBuffer(0);
  if (ready < 0 || control(descriptor_, VIDIOC_DQBUF, &buffer) != 0) {
    return ready > 0 && errno == EAGAIN ? Outcome::kTimeout : Outcome::kLost;
  }
  const bool whole = buffer.index < buffers_.size() && (buffer.flags & V4L2_BUF_FLAG_ERROR) == 0 &&
                     buffer.bytesused >= frame_size_ && buffers_[buffer.index].size >= frame_size_;
  if (whole) {
    callback(
        {static_cast<const std::uint8_t*>(buffers_[buffer.index].memory), buffer.sequence, ageOf(buffer)});
  }
  if (control(descriptor_, VIDIOC_QBUF, &buffer) != 0) {
    return Outcome::kLost;
  }
  return whole ? Outcome::kFrame : Outcome::kShortFrame;
}

bool V4l2Camera::setBrightness(int brightness) {
  v4l2_control value{V4L2_CID_BRIGHTNESS, brightness};
  return control(descriptor_, VIDIOC_S_CTRL, &value) == 0;
}

}  // namespace perennial
