#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "perennial/core/feature.h"
#include "perennial/core/parameter_reader.h"

namespace perennial {

/// What descriptors compare.
enum class DescriptorKind : std::uint8_t {
  kIntensity = 0,    ///< smoothed intensities, as published
  kOrientation = 1,  ///< mainly orientations of edges: unchanged when contrasts turn over
};

/// "intensity" or "orientation".
const char* nameOf(DescriptorKind kind);
/// None for another name.
std::optional<DescriptorKind> descriptorKind(const std::string& name);

/// What is extracted from an image. A map is usable only with the settings it was taught with, see
/// `describe()`.
struct ExtractionSettings {
  int features = 500;  ///< N: described features wanted per image, the strongest ones
  int octaves = 4;     ///< octaves of the scale space
  int layers = 3;      ///< layers per octave in which maxima are sought
  /// Features weaker than this are never used, however few there are. The default is about the strongest
  /// response of white noise with a deviation of 2 grey levels, so that a dark image does not fill up with
  /// noise; the weakest of 500 features of an image in daylight has some 100 times more.
  double min_response = 3e-6;
  /// Extract from the image at half its width and height (each pixel the mean of four). Coordinates and
  /// scales are those of the full image all the same; a descriptor covers twice the width.
  bool half_resolution = true;
  /// With more than one bucket the N features are spread over a grid of buckets: the strongest of every
  /// bucket first, then the second strongest of every one, and so on. 1 x 1: the strongest N wherever they
  /// are.
  int bucket_columns = 16;
  int bucket_rows = 8;
  DescriptorKind descriptor = DescriptorKind::kOrientation;  ///< "intensity" or "orientation"

  /// As in the reference: full resolution, the strongest N wherever they are, intensities compared.
  static ExtractionSettings published() {
    ExtractionSettings settings;
    settings.half_resolution = false;
    settings.bucket_columns = settings.bucket_rows = 1;
    settings.descriptor = DescriptorKind::kIntensity;
    return settings;
  }

  /// Keys as the members are called. Throws ParameterError.
  static ExtractionSettings load(ParameterReader& reader);

  /// Canonical text, equal for equal settings, stored with a map: "surf-brief/1 features=500 octaves=4 ...".
  /// Resolution and buckets are named only when they are not the published ones, so that maps from before
  /// they existed stay usable; the kind of descriptor always, as map format 2 wants it.
  std::string describe() const;
};

/// Detects upright SURF keypoints and describes them by 256 bits.
///
/// The result depends on the image and the settings only: the threshold that adapts from frame to frame
/// decides how much work is done, never what comes out (see surf_detector.h). Features are ordered by falling
/// response; equal responses by y, then x, then scale. One instance serves one thread; buffers are kept
/// between calls.
class FeatureExtractor {
 public:
  /// Throws ParameterError for settings that `ExtractionSettings::load` would refuse.
  explicit FeatureExtractor(const ExtractionSettings& settings = {});
  ~FeatureExtractor();
  FeatureExtractor(FeatureExtractor&&) noexcept;
  FeatureExtractor& operator=(FeatureExtractor&&) noexcept;

  /// `image`: CV_8UC1 of any size; one too small for a single feature gives none. Throws ImageError for
  /// another type.
  FeatureSet extract(const cv::Mat& image);
  /// The same into a set whose memory is used again: after the first image of a size nothing is allocated.
  void extractInto(const cv::Mat& image, FeatureSet& features);

  const ExtractionSettings& settings() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace perennial
