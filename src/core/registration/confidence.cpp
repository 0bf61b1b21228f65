#include "core/registration/confidence.h"

#include <cmath>

namespace perennial {
namespace {

double logistic(double x) { return 1.0 / (1.0 + std::exp(-x)); }

/// Votes added to both heights, so that a lead of few votes over none counts little.
constexpr double kPrior = 4.0;

}  // namespace

double robustConfidence(const VotePeak& peak, bool by_edges) {
  const double log_lead = std::log((peak.height + kPrior) / (peak.second_height + kPrior));
  return by_edges ? logistic(-1.019 + 7.997 * log_lead) : logistic(-0.689 + 6.504 * log_lead);
}

double histogramConfidence(int inliers) {
  return logistic(-0.937 + 1.892 * std::log(static_cast<double>(inliers)));
}

}  // namespace perennial
