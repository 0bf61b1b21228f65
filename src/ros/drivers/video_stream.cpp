#include "perennial/ros/drivers/video_stream.h"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>

#include <cstdlib>
#include <opencv2/core/version.hpp>
#include <opencv2/videoio.hpp>

namespace perennial {
namespace {

int backendOf(const std::string& name) {
  if (name == "ffmpeg") {
    return cv::CAP_FFMPEG;
  }
  return name == "gstreamer" ? cv::CAP_GSTREAMER : cv::CAP_ANY;
}

/// Opens the stream, with time-outs where this OpenCV has them (FFmpeg, from 4.5.2 on; older ones wait for 30
/// s).
bool open(cv::VideoCapture& capture, const VideoStreamSettings& settings) {
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR > 5 || (CV_VERSION_MINOR == 5 && CV_VERSION_REVISION >= 2)
  if (settings.backend == "ffmpeg") {
    const int timeout_ms = static_cast<int>(1000.0 * settings.timeout_s);
    return capture.open(
        settings.url, cv::CAP_FFMPEG,
        {cv::CAP_PROP_OPEN_TIMEOUT_MSEC, timeout_ms, cv::CAP_PROP_READ_TIMEOUT_MSEC, timeout_ms});
  }
#endif
  return capture.open(settings.url, backendOf(settings.backend));
}

}  // namespace

VideoStreamSettings VideoStreamSettings::load(ParameterReader& reader) {
  VideoStreamSettings settings;
  settings.url = reader.text("url", settings.url);
  settings.backend = reader.choice("backend", settings.backend, {"ffmpeg", "gstreamer", "any"});
  settings.latency_s = reader.real("latency_s", settings.latency_s, 0.0, 10.0);
  settings.timeout_s = reader.real("timeout_s", settings.timeout_s, 0.1, 60.0);
  settings.retry_period_s = reader.real("retry_period_s", settings.retry_period_s, 0.05, 60.0);
  settings.frame_id = reader.text("frame_id", settings.frame_id);
  settings.camera_name = reader.text("camera_name", settings.camera_name);
  settings.camera_info_url = reader.text("camera_info_url", settings.camera_info_url);
  return settings;
}

VideoStream::VideoStream(ros::NodeHandle nh, ros::NodeHandle private_nh, const VideoStreamSettings& settings)
    : settings_(settings),
      transport_(nh),
      publisher_(transport_.advertiseCamera("image_raw", 1)),
      calibration_(nh, settings.camera_name, settings.camera_info_url),
      diagnostics_(nh, private_nh) {
  // Nothing may be held back: FFmpeg's own buffering costs up to half a second. TCP loses no part of an
  // image.
  setenv("OPENCV_FFMPEG_CAPTURE_OPTIONS", "rtsp_transport;tcp|fflags;nobuffer|flags;low_delay", 0);
  diagnostics_.setHardwareID(settings_.url);
  diagnostics_.add("video", this, &VideoStream::diagnose);
  diagnostics_timer_ = nh.createWallTimer(
      ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { diagnostics_.force_update(); });
  reader_ = std::thread([this] { read(); });
  publisher_thread_ = std::thread([this] { publish(); });
}

VideoStream::~VideoStream() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    end_ = true;
  }
  changed_.notify_all();
  reader_.join();
  publisher_thread_.join();
}

void VideoStream::read() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!end_) {
    lock.unlock();
    readUntilLost();
    ROS_WARN_THROTTLE(10.0, "No video from %s; trying every %.1f s.", settings_.url.c_str(),
                      settings_.retry_period_s);
    lock.lock();
    connected_ = false;
    changed_.wait_for(lock, std::chrono::duration<double>(settings_.retry_period_s), [this] { return end_; });
  }
}

void VideoStream::readUntilLost() {
  cv::VideoCapture capture;
  if (!open(capture, settings_)) {
    return;
  }
  bool first = true;
  cv::Mat pixels;
  while (capture.read(pixels) && !pixels.empty()) {
    const ros::Time now = ros::Time::now();
    const ros::Duration latency(settings_.latency_s);
    auto image = std::make_unique<Image>(
        Image{pixels.clone(), now.toSec() > settings_.latency_s ? now - latency : now});
    const std::lock_guard<std::mutex> lock(mutex_);
    if (end_) {
      return;
    }
    connections_ += first ? 1 : 0;
    first = false;
    connected_ = true;
    skipped_ += newest_ ? 1 : 0;
    newest_ = std::move(image);
    changed_.notify_all();
  }
}

void VideoStream::publish() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return end_ || newest_; });
    if (end_) {
      return;
    }
    const std::unique_ptr<Image> image = std::move(newest_);
    ++images_;
    lock.unlock();
    publishImage(*image);
    lock.lock();
  }
}

void VideoStream::publishImage(const Image& image) {
  std_msgs::Header header;
  header.stamp = image.stamp;
  header.frame_id = settings_.frame_id;
  const std::string encoding =
      image.pixels.channels() == 1 ? sensor_msgs::image_encodings::MONO8 : sensor_msgs::image_encodings::BGR8;
  const sensor_msgs::ImagePtr message = cv_bridge::CvImage(header, encoding, image.pixels).toImageMsg();
  auto info = boost::make_shared<sensor_msgs::CameraInfo>(calibration_.getCameraInfo());
  if (info->width != message->width || info->height != message->height) {
    *info = sensor_msgs::CameraInfo();  // uncalibrated, or for another size
    info->width = message->width;
    info->height = message->height;
  }
  info->header = header;
  publisher_.publish(message, info);
}

void VideoStream::diagnose(diagnostic_updater::DiagnosticStatusWrapper& report) {
  using Status = diagnostic_msgs::DiagnosticStatus;
  const std::lock_guard<std::mutex> lock(mutex_);
  report.summary(connected_ ? Status::OK : Status::ERROR, connected_ ? "streaming" : "no video");
  report.add("images", images_);
  report.add("skipped images", skipped_);
  report.add("connections", connections_);
}

}  // namespace perennial
