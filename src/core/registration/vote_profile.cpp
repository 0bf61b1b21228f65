#include "core/registration/vote_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <tuple>

namespace perennial {
namespace {

constexpr double kBin_px = 4.0;  // a quarter of the kernel: what a bin hides, smoothing would hide too
constexpr int kReach = 12;       // bins on either side of the kernel: 3.2 deviations
/// Kernels of the refinement, coarse to fine: the fine one is what makes the displacement accurate.
constexpr std::array<double, 2> kRefinement_px{VoteProfile::kKernel_px, 8.0};
constexpr int kShifts = 4;  // mean shifts with each

using Kernel = std::array<double, kReach + 1>;

Kernel gaussian() {
  Kernel kernel{};
  for (std::size_t k = 0; k < kernel.size(); ++k) {
    const double offset = static_cast<double>(k) * kBin_px / VoteProfile::kKernel_px;
    kernel[k] = std::exp(-0.5 * offset * offset);
  }
  return kernel;
}

/// Sums over the votes within reach of a place: weights, and their moments about the place.
struct Moments {
  double weight = 0.0;
  double first = 0.0;
  double second = 0.0;
};

template <class Weight>
Moments momentsAbout(double place_px, const std::vector<Vote>& votes, double reach_px, const Weight& weight) {
  Moments moments;
  for (const Vote& vote : votes) {
    const double offset = vote.displacement_px - place_px;
    if (std::abs(offset) <= reach_px) {
      const double w = vote.weight * weight(offset);
      moments.weight += w;
      moments.first += w * offset;
      moments.second += w * offset * offset;
    }
  }
  return moments;
}

double refine(double place_px, const std::vector<Vote>& votes) {
  for (const double kernel_px : kRefinement_px) {
    for (int shift = 0; shift < kShifts; ++shift) {
      const auto weight = [&](double offset) {
        return std::exp(-0.5 * offset * offset / (kernel_px * kernel_px));
      };
      const Moments moments = momentsAbout(place_px, votes, 3.0 * kernel_px, weight);
      place_px += moments.weight > 0.0 ? moments.first / moments.weight : 0.0;
    }
  }
  return place_px;
}

}  // namespace

VotePeak VoteProfile::findPeak(const std::vector<Vote>& votes, const EdgeCorrelation* edges) {
  collect(votes, edges != nullptr ? edges->reach_px() : 0.0);
  smooth();
  if (edges != nullptr) {
    add(*edges);
  }
  const int best = highest();
  VotePeak peak;
  peak.height = smoothed_[static_cast<std::size_t>(best + half_)];
  const int elsewhere = static_cast<int>(kElsewhere_px / kBin_px);
  for (int bin = -half_; bin <= half_; ++bin) {
    if (std::abs(bin - best) > elsewhere) {
      peak.second_height = std::max(peak.second_height, smoothed_[static_cast<std::size_t>(bin + half_)]);
    }
  }
  peak.displacement_px = refine(best * kBin_px, votes);
  const Moments around =
      momentsAbout(peak.displacement_px, votes, 2.0 * kKernel_px, [](double /*offset*/) { return 1.0; });
  peak.width_px = around.weight > 0.0 ? std::sqrt(around.second / around.weight) : 2.0 * kKernel_px;
  return peak;
}

void VoteProfile::collect(const std::vector<Vote>& votes, double reach_px) {
  double largest = reach_px;
  for (const Vote& vote : votes) {
    largest = std::max(largest, std::abs(vote.displacement_px));
  }
  half_ = static_cast<int>(std::lround(largest / kBin_px)) + 1;
  bins_.assign(static_cast<std::size_t>(2 * (half_ + kReach) + 1), 0.0);
  for (const Vote& vote : votes) {
    bins_[static_cast<std::size_t>(std::lround(vote.displacement_px / kBin_px) + half_ + kReach)] +=
        vote.weight;
  }
}

void VoteProfile::smooth() {
  static const Kernel kernel = gaussian();
  smoothed_.resize(static_cast<std::size_t>(2 * half_ + 1));
  const double* const bins = bins_.data() + kReach;
  double* const smoothed = smoothed_.data();
  const int size = 2 * half_ + 1;
  for (int i = 0; i < size; ++i) {
    smoothed[i] = kernel[0] * bins[i];
  }
  for (int k = 1; k <= kReach; ++k) {
    const double weight = kernel[static_cast<std::size_t>(k)];
    for (int i = 0; i < size; ++i) {
      // Both sides at once: a mirrored profile is then smoothed to the mirrored result, to the bit.
      smoothed[i] += weight * (bins[i - k] + bins[i + k]);
    }
  }
}

void VoteProfile::add(const EdgeCorrelation& edges) {
  for (int bin = -half_; bin <= half_; ++bin) {
    smoothed_[static_cast<std::size_t>(bin + half_)] += kEdgeWeight * edges.at(bin * kBin_px);
  }
}

int VoteProfile::highest() const {
  const auto rank = [&](int bin) {
    return std::make_tuple(smoothed_[static_cast<std::size_t>(bin + half_)], -std::abs(bin), bin);
  };
  int best = -half_;
  for (int bin = 1 - half_; bin <= half_; ++bin) {
    if (rank(bin) > rank(best)) {
      best = bin;
    }
  }
  return best;
}

}  // namespace perennial
