#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "perennial/core/feature.h"
#include "perennial/core/parameter_reader.h"

namespace perennial {

/// What became of a map feature in one registration.
enum class FeatureState : std::uint8_t {
  kNotMatched = 0,          ///< found no partner
  kMatchedCorrectly = 1,    ///< paired, and the pair agrees with the displacement
  kMatchedIncorrectly = 2,  ///< paired, but the pair disagrees, or no displacement was found
};

struct RegistrationSettings {
  double ratio = 0.7;               ///< a pair needs distance(nearest) < ratio * distance(second nearest)
  double max_vertical_px = 50.0;    ///< pairs whose vertical difference exceeds this are dropped
  double bin_width_px = 20.0;       ///< width of the histogram's bins
  int min_inliers = 5;              ///< fewer agreeing pairs: no displacement

  /// Keys as the members are called. Throws ParameterError.
  static RegistrationSettings load(ParameterReader& reader);
};

/// Votes for horizontal displacements. Bin k, for k in [-half, half], stands at `counts[k + half]` and holds the
/// differences that round to k bin widths, halves away from zero: the bins are symmetric about 0.
struct DisplacementHistogram {
  double bin_width_px = 0.0;
  std::vector<int> counts;  ///< odd length; the middle one is centred on 0

  int half() const { return static_cast<int>(counts.size() / 2); }
  /// The displacement on which a bin is centred, by its position in `counts`.
  double centre(std::size_t position) const {
    return (static_cast<double>(position) - static_cast<double>(half())) * bin_width_px;
  }
};

/// Result of registering a view against a map.
struct RegistrationResult {
  /// x_map - x_view, px; none when fewer than `min_inliers` pairs agree.
  std::optional<double> displacement_px;
  int inliers = 0;  ///< pairs that agree with the best displacement, also when they are too few
  int matches = 0;  ///< pairs within the vertical gate, agreeing or not
  DisplacementHistogram histogram;
  std::vector<FeatureState> states;        ///< one per map feature
  std::vector<std::int32_t> partners;      ///< one per map feature: index of the view feature, or -1
};

/// Registration by voting, as in Halodova et al., IROS 2019, section III: Hamming matching with a ratio test, a
/// vertical gate, a histogram of horizontal differences, and the mean of the differences around its fullest bin.
///
/// Degenerate input (no features, one feature, no second neighbour, nothing within the gate) gives no displacement.
/// A ratio needs a second neighbour, so a view of a single feature matches nothing. Of several equally full bins the
/// one whose two neighbours hold more wins, then the one nearer to zero, then the positive one. Stateless; safe to
/// use from several threads.
class HistogramRegistration {
 public:
  explicit HistogramRegistration(const RegistrationSettings& settings = {}) : settings_(settings) {}

  RegistrationResult registerView(const FeatureSet& map, const FeatureSet& view) const;

  const RegistrationSettings& settings() const { return settings_; }

 private:
  RegistrationSettings settings_;
};

}  // namespace perennial
