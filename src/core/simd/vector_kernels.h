#pragma once

#include <vector>

#include "core/simd/kernels.h"

namespace perennial {

/// Appends the vector paths that this processor can run, the best one last; none in a build without Highway.
void appendVectorKernels(std::vector<const Kernels*>& kernels);

}  // namespace perennial
