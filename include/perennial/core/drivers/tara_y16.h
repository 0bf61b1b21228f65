#pragma once

#include <cstddef>
#include <cstdint>

namespace perennial {

/// Splits what the TARA calls a Y16 picture in its two views: of every 16-bit word the even byte is the left
/// view's pixel and the odd byte the right one's. `left` and `right` have room for `pixels` bytes, `words`
/// holds twice as many; none of them overlap. Written so that compilers turn it into vector code.
void splitY16(const std::uint8_t* words, std::size_t pixels, std::uint8_t* left,
              std::uint8_t* right) noexcept;

/// The inverse, for simulation.
void mergeY16(const std::uint8_t* left, const std::uint8_t* right, std::size_t pixels,
              std::uint8_t* words) noexcept;

/// Mean of the upper half of a view of `width` x `height` bytes: sky and trees rather than the robot's own
/// shadow.
double upperHalfMean(const std::uint8_t* view, std::size_t width, std::size_t height) noexcept;

}  // namespace perennial
