#pragma once

#include <cstddef>
#include <functional>

namespace perennial {

/// Runs task(0) ... task(count - 1), each once, in order of their numbers as threads become free, and waits
/// for all. `threads`: 0 for one per processor. The first exception stops what has not begun and is thrown
/// here.
void parallelFor(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& task);

}  // namespace perennial
