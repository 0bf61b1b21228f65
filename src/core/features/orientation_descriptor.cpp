#include "core/features/orientation_descriptor.h"

#include <cstddef>
#include <cstdint>

namespace perennial {
namespace {

constexpr std::size_t kGroup = 8;        // tests, of which
constexpr std::size_t kOfIntensity = 2;  // the first two are of intensities

}  // namespace

void OrientationDescriptor::prepare(const cv::Mat& image, const IntegralImage& integral) {
  intensity_.compute(integral);
  orientation_.compute(image);
  integral_.compute(orientation_.cosine());
  cosine_.compute(integral_);
  integral_.compute(orientation_.sine());
  sine_.compute(integral_);
  offsets_.place(image.cols);
}

Descriptor OrientationDescriptor::describe(const Pixel& centre) const noexcept {
  const std::uint16_t* const intensity = intensity_.at(centre.x, centre.y);
  const std::uint16_t* const cosine = cosine_.at(centre.x, centre.y);
  const std::uint16_t* const sine = sine_.at(centre.x, centre.y);
  Descriptor descriptor;
  const auto setBit = [&](std::size_t i, std::uint64_t bit) { descriptor.words[i / 64] |= bit << (i % 64); };
  for (std::size_t group = 0; group < Descriptor::kBits; group += kGroup) {
    for (std::size_t i = group; i < group + kOfIntensity; ++i) {
      const std::size_t other = (i + Descriptor::kBits / 2) % Descriptor::kBits;
      setBit(i, offsets_.test(i, intensity) ^ offsets_.test(other, intensity));
    }
    for (std::size_t i = group + kOfIntensity; i < group + kGroup; i += 2) {
      setBit(i, offsets_.test(i, cosine));
      setBit(i + 1, offsets_.test(i + 1, sine));
    }
  }
  return descriptor;
}

}  // namespace perennial
