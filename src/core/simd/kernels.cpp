#include "core/simd/kernels.h"

#include <atomic>

#include "core/features/box_hessian.h"
#include "core/features/box_sums.h"
#include "core/features/integral_image.h"
#include "core/features/maxima.h"
#include "core/features/orientation_image.h"
#include "core/registration/descriptor_table.h"
#include "core/registration/edge_correlation.h"
#include "core/registration/neighbour_list.h"
#include "core/simd/vector_kernels.h"

namespace perennial {
namespace {

void scalarHessianRow(const ColumnDifferences& differences, const BoxFilter& filter, int begin, int count,
                      float* responses) {
  hessianRow(differences, filter, begin, 1, count, responses);
}

constexpr Kernels kScalar{"scalar",         differenceColumns, false,       filterRowAbove, scalarHessianRow,
                          everyOther,       nextPeak,          integralRow, boxSumRow,      orientationRow,
                          hammingDistances, smallestTwo,       offerRow,    productSum};

std::vector<const Kernels*> findAvailable() {
  std::vector<const Kernels*> available{&kScalar};
  appendVectorKernels(available);
  return available;
}

std::atomic<const Kernels*>& inUse() noexcept {
  static std::atomic<const Kernels*> chosen{availableKernels().back()};
  return chosen;
}

}  // namespace

const std::vector<const Kernels*>& availableKernels() {
  static const std::vector<const Kernels*> available = findAvailable();
  return available;
}

const Kernels& kernels() noexcept { return *inUse().load(std::memory_order_relaxed); }

void useKernels(const Kernels& chosen) noexcept { inUse().store(&chosen, std::memory_order_relaxed); }

}  // namespace perennial
