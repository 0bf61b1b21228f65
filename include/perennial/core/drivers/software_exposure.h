#pragma once

#include <cstdint>
#include <optional>

namespace perennial {

struct SoftwareExposureSettings {
  double target_brightness = 128.0;  ///< wanted mean, 0..255
  double gain = 1.0;                 ///< part of the way that one step goes, 0..5
  int every_nth_image = 5;           ///< the camera needs some images to follow
};

/// Exposure control in software: every few images E += gain (target / mean E - E), with the mean of the upper
/// half of an image, as used in the field with this camera. A black image, whose mean says nothing, doubles
/// the exposure; no step is more than eightfold; the result stays within the camera's range. Not thread-safe.
class SoftwareExposure {
 public:
  explicit SoftwareExposure(const SoftwareExposureSettings& settings = {}) : settings_(settings) {}
  void set(const SoftwareExposureSettings& settings) { settings_ = settings; }

  /// Whether the next image's mean is wanted at all. Counts the image.
  bool wantsImage();

  /// The exposure to set for an image of this mean taken with `exposure`; nothing when it stays as it is.
  std::optional<std::uint32_t> next(double mean, std::uint32_t exposure) const;

 private:
  SoftwareExposureSettings settings_;
  int images_ = 0;
};

}  // namespace perennial
