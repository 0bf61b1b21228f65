// Vector code through Google Highway: compiled once per instruction set, this file including itself. Must be
// built without contraction of multiplications and additions: the results are those of the scalar code, to
// the bit.
#include "core/simd/vector_kernels.h"

#include <algorithm>
#include <cstring>

#include "core/features/box_hessian.h"
#include "core/features/box_sums.h"
#include "core/features/integral_image.h"
#include "core/features/maxima.h"
#include "core/features/orientation_image.h"
#include "core/registration/descriptor_table.h"
#include "core/registration/edge_correlation.h"
#include "core/registration/neighbour_list.h"

// Native population counts and the like, where there are any.
#define HWY_WANT_AVX3_DL
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/vector_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace perennial {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

const hn::ScalableTag<std::uint32_t> kU32;
const hn::ScalableTag<float> kFloat;
const hn::ScalableTag<std::uint64_t> kU64;

using U32 = hn::Vec<hn::ScalableTag<std::uint32_t>>;
using Float = hn::Vec<hn::ScalableTag<float>>;

HWY_INLINE U32 timesThree(U32 value) { return hn::Add(hn::Add(value, value), value); }

/// At columns x..x + lanes - 1.
HWY_INLINE U32 differenceXx(const FilterRows& rows, int x) {
  return hn::Sub(hn::LoadU(kU32, rows.xx[1] + x), hn::LoadU(kU32, rows.xx[0] + x));
}

HWY_INLINE U32 differenceYy(const FilterRows& rows, int x) {
  const auto at = [x](const std::uint32_t* row) HWY_ATTR { return hn::LoadU(kU32, row + x); };
  return hn::Sub(hn::Sub(at(rows.yy[3]), at(rows.yy[0])),
                 timesThree(hn::Sub(at(rows.yy[2]), at(rows.yy[1]))));
}

HWY_INLINE U32 differenceXy(const FilterRows& rows, int x) {
  const auto at = [x](const std::uint32_t* row) HWY_ATTR { return hn::LoadU(kU32, row + x); };
  return hn::Sub(hn::Sub(at(rows.xy[1]), at(rows.xy[0])), hn::Sub(at(rows.xy[3]), at(rows.xy[2])));
}

/// Where the vector that has a column begins. Rows and differences begin and end with whole lines: whole
/// vectors need no remainder, and each is in one line.
HWY_INLINE int vectorOf(int column) {
  const int lanes = static_cast<int>(hn::Lanes(kU32));
  return column / lanes * lanes;
}

void differenceColumnsXxYy(const FilterRows& rows, int begin, int end, ColumnDifferences& differences) {
  std::uint32_t* HWY_RESTRICT xx = differences.xx.data();
  std::uint32_t* HWY_RESTRICT yy = differences.yy.data();
  for (int x = vectorOf(begin); x < end; x += static_cast<int>(hn::Lanes(kU32))) {
    hn::StoreU(differenceXx(rows, x), kU32, xx + x);
    hn::StoreU(differenceYy(rows, x), kU32, yy + x);
  }
}

void differenceColumns(const FilterRows& rows, int begin, int end, ColumnDifferences& differences) {
  std::uint32_t* HWY_RESTRICT xy = differences.xy.data();
  HWY_NAMESPACE::differenceColumnsXxYy(rows, begin, end, differences);
  for (int x = vectorOf(begin); x < end; x += static_cast<int>(hn::Lanes(kU32))) {
    hn::StoreU(differenceXy(rows, x), kU32, xy + x);
  }
}

HWY_INLINE Float scaled(U32 sum, Float norm) {
  return hn::Mul(hn::ConvertTo(kFloat, hn::BitCast(hn::ScalableTag<std::int32_t>(), sum)), norm);
}

void hessianRow(const ColumnDifferences& differences, const BoxFilter& filter, int begin, int count,
                float* HWY_RESTRICT responses) {
  const int lanes = static_cast<int>(hn::Lanes(kFloat));
  const int lobe = filter.lobe;
  const int half = filter.half();
  const int half_lobe = lobe / 2;
  const Float norm = hn::Set(kFloat, responseNorm(filter));
  const Float weight = hn::Set(kFloat, kMixedWeight);
  const std::uint32_t* HWY_RESTRICT xx = differences.xx.data() + begin;
  const std::uint32_t* HWY_RESTRICT yy = differences.yy.data() + begin;
  const std::uint32_t* HWY_RESTRICT xy = differences.xy.data() + begin;
  int i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto at = [i](const std::uint32_t* values) HWY_ATTR { return hn::LoadU(kU32, values + i); };
    const U32 sum_xx = hn::Sub(hn::Sub(at(xx + half + 1), at(xx - half)),
                               timesThree(hn::Sub(at(xx + half_lobe + 1), at(xx - half_lobe))));
    const U32 sum_yy = hn::Sub(at(yy + lobe), at(yy + 1 - lobe));
    const U32 sum_xy = hn::Sub(hn::Sub(at(xy), at(xy - lobe)), hn::Sub(at(xy + lobe + 1), at(xy + 1)));
    const Float dxx = scaled(sum_xx, norm);
    const Float dyy = scaled(sum_yy, norm);
    const Float dxy = scaled(sum_xy, norm);
    hn::StoreU(hn::Sub(hn::Mul(dxx, dyy), hn::Mul(hn::Mul(weight, dxy), dxy)), kFloat, responses + i);
  }
  perennial::hessianRow(differences, filter, begin + i, 1, count - i, responses + i);
}

int hessianRowAbove(const FilterRows& rows, const ColumnDifferences& differences, const BoxFilter& filter,
                    int begin, int count, float threshold, float* HWY_RESTRICT responses) {
  const int lanes = static_cast<int>(hn::Lanes(kFloat));
  const int lobe = filter.lobe;
  const int half = filter.half();
  const int half_lobe = lobe / 2;
  const Float norm = hn::Set(kFloat, responseNorm(filter));
  const Float weight = hn::Set(kFloat, kMixedWeight);
  const Float least = hn::Set(kFloat, threshold);
  const Float below = hn::Set(kFloat, kBelowThreshold);
  const std::uint32_t* HWY_RESTRICT xx = differences.xx.data() + begin;
  const std::uint32_t* HWY_RESTRICT yy = differences.yy.data() + begin;
  int total = 0;
  int i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto at = [i](const std::uint32_t* values) HWY_ATTR { return hn::LoadU(kU32, values + i); };
    const U32 sum_xx = hn::Sub(hn::Sub(at(xx + half + 1), at(xx - half)),
                               timesThree(hn::Sub(at(xx + half_lobe + 1), at(xx - half_lobe))));
    const U32 sum_yy = hn::Sub(at(yy + lobe), at(yy + 1 - lobe));
    const Float bound = hn::Mul(scaled(sum_xx, norm), scaled(sum_yy, norm));
    if (hn::AllFalse(kFloat, hn::Ge(bound, least))) {
      hn::StoreU(below, kFloat, responses + i);
      continue;
    }
    const int x = begin + i;
    const U32 sum_xy = hn::Sub(hn::Sub(differenceXy(rows, x), differenceXy(rows, x - lobe)),
                               hn::Sub(differenceXy(rows, x + lobe + 1), differenceXy(rows, x + 1)));
    const Float dxy = scaled(sum_xy, norm);
    hn::StoreU(hn::Sub(bound, hn::Mul(hn::Mul(weight, dxy), dxy)), kFloat, responses + i);
    total += lanes;
  }
  return total + perennial::hessianRowAbove(rows, differences, filter, begin + i, count - i, threshold,
                                            responses + i);
}

#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
#include "core/simd/fused_hessian-inl.h"
#define PERENNIAL_FUSED(lobe) \
  case lobe:                  \
    return fusedRowAbove<lobe>(rows, count, threshold, responses)
#endif

int filterRowAbove(const FilterRows& rows, const BoxFilter& filter, int begin, int count, float threshold,
                   ColumnDifferences& differences, float* responses) {
#ifdef PERENNIAL_FUSED
  if (begin == filter.half()) {
    switch (filter.lobe) {
      PERENNIAL_FUSED(3);
      PERENNIAL_FUSED(5);
      PERENNIAL_FUSED(7);
      PERENNIAL_FUSED(9);
      PERENNIAL_FUSED(11);
      default:
        break;
    }
  }
#endif
  HWY_NAMESPACE::differenceColumnsXxYy(rows, begin - filter.half(), begin + count + filter.half() + 1,
                                       differences);
  return HWY_NAMESPACE::hessianRowAbove(rows, differences, filter, begin, count, threshold, responses);
}
#undef PERENNIAL_FUSED

void everyOther(const float* from, int count, float* to) {
  const int lanes = static_cast<int>(hn::Lanes(kFloat));
  int i = 0;
  for (; i + lanes <= count; i += lanes) {
    Float even;
    Float odd;
    hn::LoadInterleaved2(kFloat, from + 2 * i, even, odd);
    hn::StoreU(even, kFloat, to + i);
  }
  perennial::everyOther(from + 2 * i, count - i, to + i);
}

int nextPeak(const float* up, const float* here, const float* down, int begin, int end, float threshold) {
  const int lanes = static_cast<int>(hn::Lanes(kFloat));
  const Float least = hn::Set(kFloat, threshold);
  for (int i = begin; i < end; i += lanes) {
    const Float value = hn::LoadU(kFloat, here + i);
    const auto high = hn::Ge(value, least);
    if (hn::AllFalse(kFloat, high)) {
      continue;
    }
    const Float earlier = hn::Max(hn::LoadU(kFloat, here + i - 1), hn::LoadU(kFloat, up + i));
    const Float later = hn::Max(hn::LoadU(kFloat, here + i + 1), hn::LoadU(kFloat, down + i));
    const auto peak = hn::And(high, hn::And(hn::Ge(value, earlier), hn::Gt(value, later)));
    const auto first = hn::FindFirstTrue(kFloat, peak);
    if (first >= 0) {
      return std::min(end, i + static_cast<int>(first));
    }
  }
  return std::max(begin, end);
}

#if HWY_TARGET == HWY_SCALAR
using perennial::integralRow;
#else
/// Sums within four pixels at a time, and the sum so far added to all of them.
void integralRow(const std::uint8_t* pixels, const std::uint32_t* above, int columns,
                 std::uint32_t* HWY_RESTRICT sums) {
  const hn::FixedTag<std::uint32_t, 4> u32;
  const hn::FixedTag<std::uint8_t, 4> u8;
  auto row_sum = hn::Zero(u32);
  sums[0] = 0;
  int x = 0;
  for (; x + 4 <= columns; x += 4) {
    auto sum = hn::PromoteTo(u32, hn::LoadU(u8, pixels + x));
    sum = hn::Add(sum, hn::ShiftLeftLanes<1>(sum));
    sum = hn::Add(sum, hn::ShiftLeftLanes<2>(sum));
    sum = hn::Add(sum, row_sum);
    row_sum = hn::Broadcast<3>(sum);
    hn::StoreU(hn::Add(sum, hn::LoadU(u32, above + x + 1)), u32, sums + x + 1);
  }
  std::uint32_t rest = hn::GetLane(row_sum);
  for (; x < columns; ++x) {
    rest += pixels[x];
    sums[x + 1] = above[x + 1] + rest;
  }
}
#endif

void boxSumRow(const std::uint32_t* above, const std::uint32_t* below, int side, int count,
               std::uint16_t* HWY_RESTRICT sums) {
  const hn::Rebind<std::uint16_t, hn::ScalableTag<std::uint32_t>> u16;
  const int lanes = static_cast<int>(hn::Lanes(kU32));
  int x = 0;
  for (; x + lanes <= count; x += lanes) {
    const auto at = [x](const std::uint32_t* row) HWY_ATTR { return hn::LoadU(kU32, row + x); };
    const U32 sum = hn::Sub(hn::Sub(at(below + side), at(below)), hn::Sub(at(above + side), at(above)));
    hn::StoreU(hn::DemoteTo(u16, hn::BitCast(hn::ScalableTag<std::int32_t>(), sum)), u16, sums + x);
  }
  perennial::boxSumRow(above + x, below + x, side, count - x, sums + x);
}

void orientationRow(const std::uint16_t* up, const std::uint16_t* here, const std::uint16_t* down, int count,
                    std::uint8_t* HWY_RESTRICT cosine, std::uint8_t* HWY_RESTRICT sine) {
  const hn::ScalableTag<std::int32_t> i32;
  const hn::Rebind<std::uint16_t, decltype(i32)> u16;
  const hn::Rebind<std::uint8_t, decltype(i32)> u8;
  const Float noise = hn::Set(kFloat, kOrientationNoise);
  const Float amplitude = hn::Set(kFloat, 127.0F);
  const Float middle = hn::Set(kFloat, 128.0F);
  const int lanes = static_cast<int>(hn::Lanes(i32));
  int i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto at = [=](const std::uint16_t* row)
                        HWY_ATTR { return hn::PromoteTo(i32, hn::LoadU(u16, row + i)); };
    const auto twice = [](auto value) HWY_ATTR { return hn::Add(value, value); };
    const auto rising = hn::Sub(at(down + 2), at(up));
    const auto falling = hn::Sub(at(up + 2), at(down));
    const auto dx = hn::Add(hn::Add(rising, falling), twice(hn::Sub(at(here + 2), at(here))));
    const auto dy = hn::Add(hn::Sub(rising, falling), twice(hn::Sub(at(down + 1), at(up + 1))));
    const Float x = hn::ConvertTo(kFloat, dx);
    const Float y = hn::ConvertTo(kFloat, dy);
    const Float xx = hn::Mul(x, x);
    const Float yy = hn::Mul(y, y);
    const Float xy = hn::Mul(x, y);
    const Float scale = hn::Div(amplitude, hn::Add(hn::Add(xx, yy), noise));
    const auto store = [=](Float value, std::uint8_t* to) HWY_ATTR {
      const auto whole = hn::ConvertTo(i32, hn::Add(hn::Mul(value, scale), middle));
      hn::StoreU(hn::DemoteTo(u8, whole), u8, to + i);
    };
    store(hn::Sub(xx, yy), cosine);
    store(hn::Add(xy, xy), sine);
  }
  perennial::orientationRow(up + i, here + i, down + i, count - i, cosine + i, sine + i);
}

/// To as many descriptors as there are lanes, from the j-th on.
template <class U16Tag>
HWY_INLINE hn::Vec<U16Tag> distancesTo(const Descriptor& descriptor, const DescriptorTable& table,
                                       std::size_t j, U16Tag u16) {
  const hn::Rebind<std::uint32_t, decltype(kU64)> u32;
  auto sum = hn::Zero(kU64);
  for (std::size_t w = 0; w < DescriptorTable::kWords; ++w) {
    const auto word = hn::Set(kU64, descriptor.words[w]);
    sum = hn::Add(sum, hn::PopulationCount(hn::Xor(word, hn::LoadU(kU64, table.word(w) + j))));
  }
  return hn::DemoteTo(u16, hn::BitCast(hn::RebindToSigned<decltype(u32)>(), hn::TruncateTo(u32, sum)));
}

void hammingDistances(const Descriptor& descriptor, const DescriptorTable& table, std::size_t begin,
                      std::size_t end, std::uint16_t* HWY_RESTRICT distances) {
  const hn::Rebind<std::uint16_t, hn::ScalableTag<std::uint64_t>> u16;
  static_assert(hn::MaxLanes(kU64) <= DescriptorTable::kReadBeyond, "the last vector ends behind the table");
  const std::size_t lanes = hn::Lanes(kU64);
  std::size_t j = begin;
  for (; j + lanes <= end; j += lanes) {
    hn::StoreU(distancesTo(descriptor, table, j, u16), u16, distances + (j - begin));
  }
  if (j < end) {
    HWY_ALIGN std::uint16_t last[hn::MaxLanes(u16)];
    hn::StoreU(distancesTo(descriptor, table, j, u16), u16, last);
    std::copy_n(last, end - j, distances + (j - begin));
  }
}

std::int32_t productSum(const std::int16_t* a, const std::int16_t* b, std::size_t stride, std::size_t rows,
                        std::size_t count) {
  const hn::ScalableTag<std::int16_t> i16;
  const hn::ScalableTag<std::int32_t> i32;
  const std::size_t lanes = hn::Lanes(i16);
  auto even = hn::Zero(i32);
  auto odd = hn::Zero(i32);
  for (std::size_t y = 0; y < rows; ++y) {
    for (std::size_t x = y * stride; x < y * stride + count; x += lanes) {
      even = hn::ReorderWidenMulAccumulate(i32, hn::LoadU(i16, a + x), hn::LoadU(i16, b + x), even, odd);
    }
  }
  return hn::GetLane(hn::SumOfLanes(i32, hn::Add(even, odd)));
}

SmallestTwo smallestTwo(const std::uint16_t* distances, std::size_t count) {
  const hn::ScalableTag<std::uint16_t> u16;
  const std::size_t lanes = hn::Lanes(u16);
  auto first = hn::Set(u16, SmallestTwo::kNone);
  auto second = first;
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto next = hn::LoadU(u16, distances + i);
    second = hn::Min(second, hn::Max(first, next));
    first = hn::Min(first, next);
  }
  SmallestTwo smallest = perennial::smallestTwo(distances + i, count - i);
  HWY_ALIGN std::uint16_t found[2 * hn::MaxLanes(u16)];
  hn::Store(first, u16, found);
  hn::Store(second, u16, found + lanes);
  for (std::size_t lane = 0; lane < 2 * lanes; ++lane) {
    smallest.offer(found[lane]);
  }
  return smallest;
}

/// So many lanes at most that a mask has a bit for each.
const hn::CappedTag<std::uint16_t, 64> kU16;
using U16 = hn::Vec<hn::CappedTag<std::uint16_t, 64>>;

template <class Mask>
HWY_INLINE std::uint64_t bitsOf(Mask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(kU16, mask, bytes);
  std::uint64_t bits = 0;
  std::memcpy(&bits, bytes, sizeof(bits));
  return bits;
}

/// Takes the lowest of the set bits away.
HWY_INLINE std::size_t takeLowest(std::uint64_t& bits) {
  const std::size_t lowest = hwy::Num0BitsBelowLS1Bit_Nonzero64(bits);
  bits &= bits - 1;
  return lowest;
}

/// So many of the lanes, and perhaps others, are not above what is returned: the smallest in turn.
HWY_INLINE U16 boundOfSmallest(U16 lanes, std::size_t wanted) {
  const U16 none = hn::Set(kU16, NeighbourList::kNoBound);
  for (; wanted > 1; --wanted) {
    lanes = hn::IfThenElse(hn::Eq(lanes, hn::MinOfLanes(kU16, lanes)), none, lanes);
  }
  return hn::MinOfLanes(kU16, lanes);
}

void offerRow(const OfferedRow& row, NeighbourList& of_map, NeighbourList* HWY_RESTRICT of_view,
              std::uint16_t* HWY_RESTRICT bounds) {
  const std::size_t lanes = hn::Lanes(kU16);
  U16 least = hn::Set(kU16, NeighbourList::kNoBound);
  for (std::size_t begin = 0; begin < row.count; begin += lanes) {
    const U16 distances = hn::LoadU(kU16, row.distances + begin);
    least = hn::Min(least, distances);
    std::uint64_t nearer = bitsOf(hn::Lt(distances, hn::LoadU(kU16, bounds + begin)));
    while (nearer != 0) {
      const std::size_t place = begin + takeLowest(nearer);
      NeighbourList& list = of_view[row.view_indices[place]];
      list.offer(row.distances[place], row.index);
      bounds[place] = list.bound();
    }
  }
  // The nearest of each lane: the fifth of these is not below the fifth of all.
  const U16 bound = boundOfSmallest(least, NeighbourList::kCapacity);
  for (std::size_t begin = 0; begin < row.count; begin += lanes) {
    const U16 distances = hn::LoadU(kU16, row.distances + begin);
    std::uint64_t near = bitsOf(hn::Eq(distances, hn::Min(distances, bound)));  // not above it
    while (near != 0) {
      const std::size_t place = begin + takeLowest(near);
      if (place < row.count) {
        of_map.offer(row.distances[place], row.view_indices[place]);
      }
    }
  }
}

const Kernels* vectorKernels() {
  static constexpr const char* kName = HWY_TARGET == HWY_AVX3_DL ? "avx512dl"
                                       : HWY_TARGET == HWY_AVX3  ? "avx512"
                                       : HWY_TARGET == HWY_AVX2  ? "avx2"
                                       : HWY_TARGET == HWY_SSE4  ? "sse4"
                                       : HWY_TARGET == HWY_SSSE3 ? "ssse3"
                                       : HWY_TARGET == HWY_NEON  ? "neon"
                                                                 : "baseline";
  static constexpr Kernels kTable{
      kName,       differenceColumns, true,           filterRowAbove,   hessianRow,  everyOther, nextPeak,
      integralRow, boxSumRow,         orientationRow, hammingDistances, smallestTwo, offerRow,   productSum};
  return &kTable;
}

}  // namespace HWY_NAMESPACE
}  // namespace perennial
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace perennial {

HWY_EXPORT(vectorKernels);

void appendVectorKernels(std::vector<const Kernels*>& kernels) {
  const std::size_t first = kernels.size();
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {  // the best one first
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    kernels.push_back(HWY_DYNAMIC_DISPATCH(vectorKernels)());
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  std::reverse(kernels.begin() + static_cast<std::ptrdiff_t>(first), kernels.end());
}

}  // namespace perennial
#endif
