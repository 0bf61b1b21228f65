#pragma once

#include <camera_info_manager/camera_info_manager.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <image_transport/image_transport.h>
#include <ros/node_handle.h>

#include <condition_variable>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <string>
#include <thread>

#include "perennial/core/parameter_reader.h"

namespace perennial {

struct VideoStreamSettings {
  std::string url = "rtsp://172.43.50.194/axis-media/media.amp?camera=1";
  std::string backend =
      "ffmpeg";            ///< ffmpeg, gstreamer (then url may be a pipeline that ends in appsink), any
  double latency_s = 0.2;  ///< from the light to the decoded image: subtracted from the stamp
  double timeout_s = 5.0;  ///< a stream that is silent for so long is opened anew, where OpenCV can tell
  double retry_period_s = 1.0;
  std::string frame_id = "robot_camera";
  std::string camera_name = "robot_camera";
  std::string camera_info_url;

  static VideoStreamSettings load(ParameterReader& reader);
};

/// Publishes a network camera's video as `image_raw` and `camera_info`: the newest image only, and again
/// whenever the camera comes back.
///
/// One thread reads, so that no backlog of old images builds up, another one publishes what is newest. The
/// stamp is the moment at which the image was decoded minus `latency_s`: the protocol tells no better one.
class VideoStream {
 public:
  VideoStream(ros::NodeHandle nh, ros::NodeHandle private_nh, const VideoStreamSettings& settings);
  ~VideoStream();

 private:
  struct Image {
    cv::Mat pixels;
    ros::Time stamp;
  };
  void read();
  void readUntilLost();
  void publish();
  void publishImage(const Image& image);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& report);

  const VideoStreamSettings settings_;
  image_transport::ImageTransport transport_;
  image_transport::CameraPublisher publisher_;
  camera_info_manager::CameraInfoManager calibration_;

  std::mutex mutex_;  ///< guards what follows, down to the next blank line
  std::condition_variable changed_;
  bool end_ = false;
  bool connected_ = false;
  std::unique_ptr<Image> newest_;
  std::uint64_t images_ = 0;
  std::uint64_t skipped_ = 0;  ///< replaced by a newer one before they were published
  std::uint64_t connections_ = 0;

  diagnostic_updater::Updater diagnostics_;
  ros::WallTimer diagnostics_timer_;
  std::thread reader_;
  std::thread publisher_thread_;
};

}  // namespace perennial
