#pragma once

#include "core/registration/vote_profile.h"

namespace perennial {

/// Probability that the displacement is right within 35 px. Logistic models of one variable each: how far the
/// peak leads over the highest place elsewhere, and how many pairs agree. How they were fitted stands in
/// docs/registration.md.
double robustConfidence(const VotePeak& peak, bool by_edges);
double histogramConfidence(int inliers);

}  // namespace perennial
