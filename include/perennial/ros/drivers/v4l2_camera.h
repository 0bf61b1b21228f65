#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace perennial {

/// A V4L2 device that streams Y16 pictures from memory shared with the kernel.
class V4l2Camera {
 public:
  struct Format {
    int width = 752;
    int height = 480;
    double frame_rate = 30.0;
  };
  /// Valid during the callback only.
  struct Frame {
    const std::uint8_t* words;  ///< two bytes per pixel
    std::uint32_t sequence;
    double age_s;  ///< since the picture was taken, by the kernel's monotonic clock
  };
  enum class Outcome { kFrame, kShortFrame, kTimeout, kLost };

  /// Opens, configures and starts streaming. Throws Error that says which step failed, and why.
  V4l2Camera(const std::string& path, const Format& format);
  ~V4l2Camera();
  V4l2Camera(const V4l2Camera&) = delete;
  V4l2Camera& operator=(const V4l2Camera&) = delete;

  /// Waits for the next picture and hands it to the callback before the kernel gets its memory back. kLost:
  /// the device is gone, and this object of no more use.
  Outcome grab(double timeout_s, const std::function<void(const Frame&)>& callback);

  bool setBrightness(int brightness);
  /// What the device agreed to; may differ from what was asked for.
  double frameRate() const { return frame_rate_; }

 private:
  struct Buffer {
    void* memory;
    std::size_t size;
  };
  void configure(const Format& format);
  void mapBuffers();
  void startStream();
  void release();

  std::string path_;
  int descriptor_ = -1;
  std::size_t frame_size_ = 0;
  double frame_rate_ = 0.0;
  std::vector<Buffer> buffers_;
};

}  // namespace perennial
