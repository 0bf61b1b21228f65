#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "perennial/core/parameter_reader.h"

namespace perennial {

struct ImageWatchSettings {
  int frozen_images = 10;          ///< so many identical images on the way: the camera is frozen; 0: never
  double frozen_distance_m = 0.2;  ///< two of them and so far between them: the same

  /// Keys as the members are called. Throws ParameterError.
  static ImageWatchSettings load(ParameterReader& reader);
};

/// Notices a camera that repeats one frame while the robot moves, and stamps that go backwards. Every real
/// camera has noise, and a moving one never sees the same twice to the bit. One that stands may: a still, or
/// a simulator. Not thread-safe.
class ImageWatch {
 public:
  explicit ImageWatch(const ImageWatchSettings& settings = {}) : settings_(settings) {}

  void reset();

  /// Why an image of this stamp cannot be used, judged by the newest stamp before; empty: it can.
  std::string checkStamp(double stamp_s);
  /// Why the camera is not to be trusted; empty: it is. `travelled_m`: by odometry, where the image was
  /// taken.
  std::string checkPixels(const std::uint8_t* pixels, std::size_t bytes, double travelled_m);

 private:
  ImageWatchSettings settings_;
  std::optional<double> newest_stamp_s_;
  std::vector<std::uint8_t> last_;
  int repeated_ = 0;           ///< how often in a row the last image has been repeated
  double first_seen_m_ = 0.0;  ///< travelled distance where it was first seen
};

}  // namespace perennial
