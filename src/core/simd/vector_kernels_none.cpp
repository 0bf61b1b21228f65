// Built where Google Highway is missing.
#include "core/simd/vector_kernels.h"

namespace perennial {

void appendVectorKernels(std::vector<const Kernels*>& /*kernels*/) {}

}  // namespace perennial
