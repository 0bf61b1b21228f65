#include "perennial/core/drivers/software_exposure.h"

#include <algorithm>
#include <cmath>

#include "perennial/core/drivers/tara_hid_codec.h"

namespace perennial {
namespace {

constexpr double kLargestFactor = 8.0;

}  // namespace

bool SoftwareExposure::wantsImage() {
  images_ = (images_ + 1) % settings_.every_nth_image;
  return images_ == 0;
}

std::optional<std::uint32_t> SoftwareExposure::next(double mean, std::uint32_t exposure) const {
  if (!(mean >= 0.0)) {
    return std::nullopt;
  }
  const double current = std::max(exposure, kTaraMinExposure);
  const double factor = mean > 0.0 ? 1.0 + settings_.gain * (settings_.target_brightness / mean - 1.0) : 2.0;
  const double wanted = current * std::clamp(factor, 1.0 / kLargestFactor, kLargestFactor);
  const auto rounded = static_cast<std::uint32_t>(
      std::lround(std::clamp(wanted, 1.0 * kTaraMinExposure, 1.0 * kTaraMaxExposure)));
  return rounded == exposure ? std::nullopt : std::optional<std::uint32_t>(rounded);
}

}  // namespace perennial
