#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
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

enum class RegistrationMethod : std::uint8_t {
  kHistogram = 0,  ///< as published, see HistogramRegistration
  kRobust = 1,     ///< see RobustRegistration
};

/// "histogram" or "robust".
const char* nameOf(RegistrationMethod method);
/// None for another name.
std::optional<RegistrationMethod> registrationMethod(const std::string& name);

struct RegistrationSettings {
  RegistrationMethod method = RegistrationMethod::kRobust;  ///< "histogram" or "robust"
  double ratio = 0.7;  ///< histogram: a pair needs distance(nearest) < ratio * distance(second nearest)
  double max_vertical_px = 50.0;  ///< pairs whose vertical difference exceeds this are dropped
  double bin_width_px = 20.0;     ///< width of the histogram's bins
  int min_inliers = 5;            ///< fewer agreeing pairs: no displacement
  double min_confidence = 0.4;    ///< lower confidence: no displacement; see docs/registration.md

  /// Keys as the members are called. Throws ParameterError.
  static RegistrationSettings load(ParameterReader& reader);
};

/// Votes for horizontal displacements. Bin k, for k in [-half, half], stands at `counts[k + half]` and holds
/// the differences that round to k bin widths, halves away from zero: the bins are symmetric about 0.
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
  /// x_map - x_view, px; none when fewer than `min_inliers` pairs agree or `min_confidence` is not reached.
  std::optional<double> displacement_px;
  /// Estimated probability that the best displacement is right within 35 px, also when it is not given; 0
  /// without any votes. Calibrated on real images, see docs/registration.md.
  double confidence = 0.0;
  double uncertainty_px =
      0.0;          ///< deviation of the agreeing votes about the displacement: the width of the peak
  int inliers = 0;  ///< pairs that agree with the best displacement, also when they are too few
  int matches = 0;  ///< pairs within the vertical gate, agreeing or not
  DisplacementHistogram histogram;
  std::vector<FeatureState> states;    ///< one per map feature
  std::vector<std::int32_t> partners;  ///< one per map feature: index of the view feature, or -1
};

/// Memory that a registration works in. Kept from call to call so that nothing is allocated once it has
/// grown; its content means nothing between calls. One serves one thread.
class RegistrationWorkspace {
 public:
  RegistrationWorkspace();
  ~RegistrationWorkspace();
  RegistrationWorkspace(RegistrationWorkspace&&) noexcept;
  RegistrationWorkspace& operator=(RegistrationWorkspace&&) noexcept;

  struct Buffers;  ///< of the implementation
  Buffers& buffers() { return *buffers_; }

 private:
  std::unique_ptr<Buffers> buffers_;
};

/// Registers views against maps. Stateless; safe to use from several threads.
///
/// Degenerate input (no features, one feature, nothing within the vertical gate) gives no displacement.
class Registration {
 public:
  explicit Registration(const RegistrationSettings& settings) : settings_(settings) {}
  virtual ~Registration() = default;

  RegistrationResult registerView(const FeatureSet& map, const FeatureSet& view) const;

  /// The same into a result whose memory is used again. Allocates nothing when workspace and result have
  /// served for as many features before.
  virtual void registerInto(const FeatureSet& map, const FeatureSet& view, RegistrationWorkspace& workspace,
                            RegistrationResult& result) const = 0;

  const RegistrationSettings& settings() const { return settings_; }

 protected:
  Registration(const Registration&) = default;
  Registration& operator=(const Registration&) = default;

 private:
  RegistrationSettings settings_;
};

/// The registration that `settings.method` asks for.
std::unique_ptr<Registration> makeRegistration(const RegistrationSettings& settings);

/// Registration by voting, as in Halodova et al., IROS 2019, section III: Hamming matching with a ratio test,
/// a vertical gate, a histogram of horizontal differences, and the mean of the differences around its fullest
/// bin.
///
/// A ratio needs a second neighbour, so a view of a single feature matches nothing. Of several equally full
/// bins the one whose two neighbours hold more wins, then the one nearer to zero, then the positive one.
class HistogramRegistration : public Registration {
 public:
  explicit HistogramRegistration(const RegistrationSettings& settings = {}) : Registration(settings) {}

  void registerInto(const FeatureSet& map, const FeatureSet& view, RegistrationWorkspace& workspace,
                    RegistrationResult& result) const override;
};

/// Registration by soft votes, for scenes that changed a lot between map and view.
///
/// Only features within the vertical gate are compared. Each map feature votes for the displacements to its
/// five nearest view features, and a vote weighs 1 / (a b) where the two are each other's a-th and b-th
/// nearest (a, b <= 5; mutual nearest neighbours have weight 1): no threshold on descriptors decides before
/// the scene as a whole is heard. To the votes, smoothed by a Gaussian, the match of both images' edges
/// (FeatureSet::edges) is added; the peak of the sum is refined by the votes to a fraction of a pixel (mean
/// shift: Comaniciu and Meer, PAMI 2002). Of equal peaks the one nearer to zero wins, then the positive one.
///
/// Pairs, which decide on the features' states and count as inliers, are mutual nearest neighbours that
/// resemble each other; they agree within 1.5 bins. `histogram` holds the pairs, in hard bins, for people to
/// look at.
class RobustRegistration : public Registration {
 public:
  explicit RobustRegistration(const RegistrationSettings& settings = {}) : Registration(settings) {}

  void registerInto(const FeatureSet& map, const FeatureSet& view, RegistrationWorkspace& workspace,
                    RegistrationResult& result) const override;
};

}  // namespace perennial
