#pragma once

#include <cmath>
#include <cstdint>
#include <initializer_list>

namespace perennial::park {

/// Mixes numbers into one well-spread 64-bit number (the finaliser of SplitMix64, Steele et al., OOPSLA
/// 2014). The park is made of such hashes of (seed, object, day), so that any part of it can be computed
/// alone and in any order.
inline std::uint64_t mix(std::initializer_list<std::int64_t> numbers) {
  std::uint64_t state = 0;
  for (const std::int64_t number : numbers) {
    state += 0x9e3779b97f4a7c15ULL + static_cast<std::uint64_t>(number);
    state = (state ^ (state >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    state = (state ^ (state >> 27U)) * 0x94d049bb133111ebULL;
    state ^= state >> 31U;
  }
  return state;
}

/// Pseudo-random numbers that are the same with every compiler and library, unlike the standard
/// distributions.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    state_ += 0x9e3779b97f4a7c15ULL;
    return mix({static_cast<std::int64_t>(state_)});
  }
  /// In [0, 1).
  double uniform() { return static_cast<double>(next() >> 11U) * 0x1.0p-53; }
  double uniform(double minimum, double maximum) { return minimum + (maximum - minimum) * uniform(); }
  /// In [0, count).
  int below(int count) { return static_cast<int>(uniform() * count); }
  /// Standard normal, by Box and Muller's method.
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * 3.14159265358979323846 * uniform());
  }

 private:
  std::uint64_t state_;
};

}  // namespace perennial::park
