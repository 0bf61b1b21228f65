#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace perennial {

/// Bytes: a line of the cache and the widest vector, which then reads one line and not two.
constexpr std::size_t kVectorBytes = 64;

template <class T>
struct VectorAllocator {
  using value_type = T;

  VectorAllocator() = default;
  template <class U>
  explicit VectorAllocator(const VectorAllocator<U>& /*other*/) noexcept {}

  T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new (count * sizeof(T), std::align_val_t{kVectorBytes}));
  }
  void deallocate(T* memory, std::size_t /*count*/) noexcept {
    ::operator delete (memory, std::align_val_t{kVectorBytes});
  }
  friend bool operator==(const VectorAllocator&, const VectorAllocator&) noexcept { return true; }
  friend bool operator!=(const VectorAllocator&, const VectorAllocator&) noexcept { return false; }
};

/// A std::vector whose first element begins a line.
template <class T>
using AlignedVector = std::vector<T, VectorAllocator<T>>;

/// How many elements fill an odd number of lines, at least `count`. Odd, so that the rows of an image do not
/// compete for the same places of the cache.
template <class T>
constexpr std::size_t wholeLines(std::size_t count) {
  constexpr std::size_t kInLine = kVectorBytes / sizeof(T);
  return (count + kInLine - 1) / kInLine * kInLine | kInLine;
}

}  // namespace perennial
