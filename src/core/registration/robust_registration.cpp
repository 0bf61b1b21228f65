#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "core/registration/confidence.h"
#include "core/registration/displacement_histogram.h"
#include "core/registration/workspace.h"
#include "core/simd/kernels.h"
#include "perennial/core/registration.h"

namespace perennial {
namespace {

/// Mutual nearest neighbours further apart than this are no pair: of those nearer, about half are right on
/// real images across a year (intensities and orientations alike), of those further apart one in seven to one
/// in four.
constexpr std::uint16_t kPairDistance = 88;

/// The view's features in order of y: those within the gate of a map feature are then neighbours.
void sortView(const FeatureSet& view, RegistrationWorkspace::Buffers& buffers) {
  buffers.by_y.resize(view.size());
  std::iota(buffers.by_y.begin(), buffers.by_y.end(), 0U);
  std::sort(buffers.by_y.begin(), buffers.by_y.end(), [&](std::uint32_t a, std::uint32_t b) {
    const float ya = view.keypoints[a].y;
    const float yb = view.keypoints[b].y;
    return ya < yb || (ya == yb && a < b);
  });
  buffers.view.resize(view.size());
  buffers.sorted_y.resize(view.size());
  for (std::size_t place = 0; place < view.size(); ++place) {
    buffers.view.set(place, view.descriptors[buffers.by_y[place]]);
    buffers.sorted_y[place] = view.keypoints[buffers.by_y[place]].y;
  }
}

/// How many of ascending values satisfy `before`, which those at the front do. Without a branch: where the
/// gate of a map feature begins cannot be predicted.
template <class Before>
std::size_t countBefore(const std::vector<float>& ascending, const Before& before) {
  if (ascending.empty()) {
    return 0;
  }
  const float* first = ascending.data();
  for (std::size_t left = ascending.size(); left > 1;) {
    const std::size_t half = left / 2;
    first += before(first[half - 1]) ? half : 0;
    left -= half;
  }
  return static_cast<std::size_t>(first - ascending.data()) + (before(*first) ? 1 : 0);
}

void findNeighbours(const FeatureSet& map, const FeatureSet& view, double gate_px,
                    RegistrationWorkspace::Buffers& buffers) {
  sortView(view, buffers);
  buffers.of_map.assign(map.size(), {});
  buffers.of_view.assign(view.size(), {});
  buffers.distances.resize(view.size() + kOfferBeyond);
  buffers.bounds.assign(view.size() + kOfferBeyond, NeighbourList::kNoBound);
  const Kernels& use = kernels();
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double here = map.keypoints[i].y;
    const std::size_t begin = countBefore(buffers.sorted_y, [&](double y) { return y < here - gate_px; });
    const std::size_t end = countBefore(buffers.sorted_y, [&](double y) { return y <= here + gate_px; });
    use.hamming_distances(map.descriptors[i], buffers.view, begin, end, buffers.distances.data());
    const std::size_t count = end - begin;
    std::fill_n(buffers.distances.data() + count, kOfferBeyond, NeighbourList::kNoBound);
    use.offer_row(
        {buffers.distances.data(), count, static_cast<std::uint32_t>(i), buffers.by_y.data() + begin},
        buffers.of_map[i], buffers.of_view.data(), buffers.bounds.data() + begin);
  }
}

void castVotes(const FeatureSet& map, const FeatureSet& view, RegistrationWorkspace::Buffers& buffers) {
  buffers.votes.clear();
  for (std::size_t i = 0; i < map.size(); ++i) {
    const NeighbourList& nearest = buffers.of_map[i];
    const std::size_t size = nearest.size();
    for (std::size_t a = 0; a < size; ++a) {
      const std::uint32_t j = nearest[a].index;
      const std::size_t b = buffers.of_view[j].rankOf(static_cast<std::uint32_t>(i));
      if (b < NeighbourList::kCapacity) {
        buffers.votes.push_back({horizontalDifference(map, view, i, static_cast<std::int32_t>(j)),
                                 1.0 / static_cast<double>((a + 1) * (b + 1))});
      }
    }
  }
}

void findPairs(std::size_t map_size, const RegistrationWorkspace::Buffers& buffers,
               std::vector<std::int32_t>& partners) {
  partners.assign(map_size, -1);
  for (std::size_t i = 0; i < map_size; ++i) {
    const NeighbourList& nearest = buffers.of_map[i];
    if (nearest.size() > 0 && nearest[0].distance <= kPairDistance &&
        buffers.of_view[nearest[0].index][0].index == i) {
      partners[i] = static_cast<std::int32_t>(nearest[0].index);
    }
  }
}

}  // namespace

void RobustRegistration::registerInto(const FeatureSet& map, const FeatureSet& view,
                                      RegistrationWorkspace& workspace, RegistrationResult& result) const {
  RegistrationWorkspace::Buffers& buffers = workspace.buffers();
  findNeighbours(map, view, settings().max_vertical_px, buffers);
  castVotes(map, view, buffers);
  findPairs(map.size(), buffers, result.partners);
  countPairs(map, view, settings().bin_width_px, result);
  result.displacement_px.reset();
  result.inliers = 0;
  result.confidence = 0.0;
  result.uncertainty_px = 0.0;
  if (buffers.votes.empty()) {
    return;
  }

  const bool by_edges = buffers.edges.compute(map.edges, view.edges);
  const VotePeak peak = buffers.profile.findPeak(buffers.votes, by_edges ? &buffers.edges : nullptr);
  result.confidence = robustConfidence(peak, by_edges);
  result.uncertainty_px = peak.width_px;
  const auto agrees = [&](double difference) {
    return std::abs(difference - peak.displacement_px) <= 1.5 * settings().bin_width_px;
  };
  forEachPair(map, view, result,
              [&](std::size_t /*i*/, double difference) { result.inliers += agrees(difference) ? 1 : 0; });
  if (result.inliers < settings().min_inliers || result.confidence < settings().min_confidence) {
    return;
  }
  result.displacement_px = peak.displacement_px;
  forEachPair(map, view, result, [&](std::size_t i, double difference) {
    if (agrees(difference)) {
      result.states[i] = FeatureState::kMatchedCorrectly;
    }
  });
}

}  // namespace perennial
