#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace perennial {

struct BoxFilter;
struct ColumnDifferences;
class DescriptorTable;
struct Descriptor;
struct FilterRows;
class NeighbourList;
struct OfferedRow;
struct SmallestTwo;

/// The loops that take the time, for one instruction set. Every path gives the same results to the last bit;
/// the scalar functions, declared where they belong, are the reference.
struct Kernels {
  const char* name;  ///< "scalar", "baseline", "ssse3", "sse4", "avx2", "avx512", "avx512dl", "neon"

  /// See differenceColumns() in box_hessian.h.
  void (*difference_columns)(const FilterRows& rows, int begin, int end, ColumnDifferences& differences);
  /// Whether filter_row_above is faster than difference_columns and hessian_row: a compiler makes more of a
  /// loop that leaves nothing out.
  bool looks_first;
  /// See filterRowAbove() in box_hessian.h.
  int (*filter_row_above)(const FilterRows& rows, const BoxFilter& filter, int begin, int count,
                          float threshold, ColumnDifferences& differences, float* responses);
  /// See hessianRow() in box_hessian.h, with a step of 1.
  void (*hessian_row)(const ColumnDifferences& differences, const BoxFilter& filter, int begin, int count,
                      float* responses);
  /// See everyOther() in box_hessian.h.
  void (*every_other)(const float* from, int count, float* to);
  /// See nextPeak() in maxima.h.
  int (*next_peak)(const float* up, const float* here, const float* down, int begin, int end,
                   float threshold);
  /// See integralRow() in integral_image.h.
  void (*integral_row)(const std::uint8_t* pixels, const std::uint32_t* above, int columns,
                       std::uint32_t* sums);
  /// See boxSumRow() in box_sums.h.
  void (*box_sum_row)(const std::uint32_t* above, const std::uint32_t* below, int side, int count,
                      std::uint16_t* sums);
  /// See orientationRow() in orientation_image.h.
  void (*orientation_row)(const std::uint16_t* up, const std::uint16_t* here, const std::uint16_t* down,
                          int count, std::uint8_t* cosine, std::uint8_t* sine);
  /// See hammingDistances() in descriptor_table.h.
  void (*hamming_distances)(const Descriptor& descriptor, const DescriptorTable& table, std::size_t begin,
                            std::size_t end, std::uint16_t* distances);
  /// See smallestTwo() in descriptor_table.h.
  SmallestTwo (*smallest_two)(const std::uint16_t* distances, std::size_t count);
  /// See offerRow() in neighbour_list.h.
  void (*offer_row)(const OfferedRow& row, NeighbourList& of_map, NeighbourList* of_view,
                    std::uint16_t* bounds);
  /// See productSum() in edge_correlation.h; `count` must be a multiple of kProductBlock.
  std::int32_t (*product_sum)(const std::int16_t* a, const std::int16_t* b, std::size_t stride,
                              std::size_t rows, std::size_t count);
};

/// What this processor can run, the scalar path first, the best one last.
const std::vector<const Kernels*>& availableKernels();

/// What is in use: the best one, unless another was chosen.
const Kernels& kernels() noexcept;

/// Chooses a path for the whole process, for tests and benchmarks. Safe at any time: all paths agree.
void useKernels(const Kernels& chosen) noexcept;

}  // namespace perennial
