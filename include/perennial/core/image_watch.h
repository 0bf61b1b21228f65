#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace perennial {

/// Notices a camera that repeats one frame while the robot moves, and stamps that go backwards. Every real
/// camera has noise, and a moving one never sees the same twice to the bit. Not thread-safe.
class ImageWatch {
 public:
  /// `frozen_images`: so many identical images in a row, with the robot moving meanwhile, are a frozen
  /// camera; 0: never.
  explicit ImageWatch(int frozen_images) : frozen_images_(frozen_images) {}

  void reset();

  /// Why an image of this stamp cannot be used, judged by the newest stamp before; empty: it can.
  std::string checkStamp(double stamp_s);
  /// Why the camera is not to be trusted; empty: it is. `travelled_m`: by odometry, where the image was
  /// taken.
  std::string checkPixels(const std::uint8_t* pixels, std::size_t bytes, double travelled_m);

 private:
  int frozen_images_;
  std::optional<double> newest_stamp_s_;
  std::vector<std::uint8_t> last_;
  int repeated_ = 0;           ///< how often in a row the last image has been repeated
  double first_seen_m_ = 0.0;  ///< travelled distance where it was first seen
};

}  // namespace perennial
