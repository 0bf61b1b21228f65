#include "perennial/core/sight.h"

#include <algorithm>

namespace perennial {
namespace {

constexpr double kSureInliers = 8.0;

}  // namespace

Sight sightOf(const RegistrationResult& result, int min_inliers) {
  const double sure = kSureInliers * std::max(1, min_inliers);
  return {result.displacement_px.has_value(), std::clamp(result.inliers / sure, 0.0, 1.0)};
}

}  // namespace perennial
