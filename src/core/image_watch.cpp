#include "perennial/core/image_watch.h"

#include <algorithm>
#include <cmath>

#include "perennial/core/human_text.h"

namespace perennial {
namespace {

/// A robot that moved less may stand, and see the same however often.
constexpr double kMoved_m = 0.05;

}  // namespace

ImageWatchSettings ImageWatchSettings::load(ParameterReader& reader) {
  ImageWatchSettings settings;
  settings.frozen_images = reader.integer("frozen_images", settings.frozen_images, 0, 1000000);
  settings.frozen_distance_m = reader.real("frozen_distance_m", settings.frozen_distance_m, kMoved_m, 1e6);
  return settings;
}

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
  if (settings_.frozen_images == 0) {
    return "";
  }
  if (last_.size() != bytes || !std::equal(last_.begin(), last_.end(), pixels)) {
    last_.assign(pixels, pixels + bytes);
    repeated_ = 0;
    first_seen_m_ = travelled_m;
    return "";
  }
  ++repeated_;
  const double moved_m = std::abs(travelled_m - first_seen_m_);
  const bool often = repeated_ >= settings_.frozen_images && moved_m >= kMoved_m;
  if (!often && moved_m < settings_.frozen_distance_m) {
    return "";
  }
  return "the camera repeats one image (" + std::to_string(repeated_) + " times in " + humanMetres(moved_m) +
         "): it is frozen";
}

}  // namespace perennial
