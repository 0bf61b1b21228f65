#include "perennial/core/image_watch.h"

#include <algorithm>
#include <cmath>

#include "perennial/core/human_text.h"

namespace perennial {
namespace {

/// A robot that moved less may stand, and see the same.
constexpr double kMoved_m = 0.05;

}  // namespace

void ImageWatch::reset() {
  newest_stamp_s_.reset();
  last_.clear();
  repeated_ = 0;
}

std::string ImageWatch::checkStamp(double stamp_s) {
  if (newest_stamp_s_ && stamp_s < *newest_stamp_s_) {
    return "the stamps of the images go back by " + humanSeconds(*newest_stamp_s_ - stamp_s);
  }
  newest_stamp_s_ = stamp_s;
  return "";
}

std::string ImageWatch::checkPixels(const std::uint8_t* pixels, std::size_t bytes, double travelled_m) {
  if (frozen_images_ == 0) {
    return "";
  }
  if (last_.size() != bytes || !std::equal(last_.begin(), last_.end(), pixels)) {
    last_.assign(pixels, pixels + bytes);
    repeated_ = 0;
    first_seen_m_ = travelled_m;
    return "";
  }
  ++repeated_;
  if (repeated_ < frozen_images_ || std::abs(travelled_m - first_seen_m_) < kMoved_m) {
    return "";
  }
  return "the camera repeats one image (" + std::to_string(repeated_) + " times): it is frozen";
}

}  // namespace perennial
