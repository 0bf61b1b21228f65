#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

namespace perennial {

/// What may happen to a view between teaching and repeating, done to an image by arithmetic.
struct Disturbance {
  enum class Kind : std::uint8_t {
    kCover,     ///< a textured object of the image's proportions covers this share of it, somewhere
    kBlur,      ///< horizontal motion blur over this many px: the robot turns while the shutter is open
    kRoll,      ///< the camera is turned about its optical axis by this many degrees
    kPitch,     ///< the camera looks up by this many degrees; a field of view of 70 degrees is assumed
    kSaturate,  ///< this share of the frame, at its left or right, is white
  };

  Kind kind = Kind::kCover;
  double amount = 0.0;

  /// From "cover=0.2", "blur=10", "roll=3", "pitch=3", "saturate=0.5". Throws ParameterError, also for an
  /// amount that makes no sense.
  static Disturbance parse(const std::string& text);
};

/// The image, CV_8UC1, disturbed. Where the object stands, how it looks and which side is white follow from
/// `seed`.
cv::Mat disturbed(const cv::Mat& image, const Disturbance& disturbance, std::uint64_t seed);

}  // namespace perennial
