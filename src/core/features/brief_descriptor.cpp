#include "core/features/brief_descriptor.h"

namespace perennial {

void BriefDescriptor::prepare(const IntegralImage& integral) {
  smoothed_.compute(integral);
  offsets_.place(integral.columns());
}

Descriptor BriefDescriptor::describe(const Pixel& centre) const noexcept {
  const std::uint16_t* const at = smoothed_.at(centre.x, centre.y);
  Descriptor descriptor;
  for (std::size_t i = 0; i < Descriptor::kBits; ++i) {
    descriptor.words[i / 64] |= offsets_.test(i, at) << (i % 64);
  }
  return descriptor;
}

}  // namespace perennial
