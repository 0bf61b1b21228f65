#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/features/integral_image.h"
#include "core/simd/aligned_vector.h"

namespace perennial {

/// Box filters that approximate the second derivatives of a Gaussian (Bay et al., CVIU 2008, section 3.2 and
/// fig. 4). The smallest one, lobe 3, is 9x9 px and stands for sigma = 1.2.
///
/// Dxx: three lobes side by side, each `lobe` wide and 2 lobe - 1 high, weighted 1, -2, 1; Dyy is Dxx
/// transposed; Dxy: four squares of `lobe` px, one px apart, weighted 1, -1, -1, 1.
struct BoxFilter {
  int lobe = 3;  ///< px, odd, at least 3

  int size() const { return 3 * lobe; }
  int half() const { return size() / 2; }  ///< px needed on each side of the centre
};

/// Weight of Dxy that balances the error of the box approximation (Bay et al., eq. 3), squared.
constexpr float kMixedWeight = 0.9F * 0.9F;

/// What a filter's sums are multiplied by: one over its area and over 255.
inline float responseNorm(const BoxFilter& filter) {
  return 1.0F / (255.0F * static_cast<float>(filter.size() * filter.size()));
}

/// sigma of the Gaussian that a filter of this size (possibly between two filters, hence real) approximates,
/// px.
constexpr float scaleOfFilterSize(float size) { return 1.2F / 9.0F * size; }

/// Differences down the columns of an integral image, for one filter and one image row. Each derivative is
/// then a few differences along the row: 20 reads for a response instead of 32.
struct ColumnDifferences {
  AlignedVector<std::uint32_t> xx;
  AlignedVector<std::uint32_t> yy;
  AlignedVector<std::uint32_t> xy;

  void resize(std::size_t columns);
};

/// Rows of an integral image that one filter touches around one image row.
struct FilterRows {
  FilterRows(const IntegralImage& integral, const BoxFilter& filter, int y);

  const std::uint32_t* xx[2];  ///< above and below the lobes of Dxx
  const std::uint32_t* yy[4];  ///< above, between and below the three lobes of Dyy
  const std::uint32_t* xy[4];  ///< above and below the upper squares of Dxy, then the lower ones
};

/// Fills columns begin..end-1 of `differences`, and perhaps others in the same lines.
void differenceColumns(const FilterRows& rows, int begin, int end, ColumnDifferences& differences) noexcept;

/// The same without `xy`.
void differenceColumnsXxYy(const FilterRows& rows, int begin, int end,
                           ColumnDifferences& differences) noexcept;

/// Whole vectors may be read so far behind the end of a row of responses.
constexpr int kReadBeyond = 64;

/// Stands for a response that was not computed because it cannot reach the threshold: less than every
/// threshold.
constexpr float kBelowThreshold = -std::numeric_limits<float>::infinity();

/// Responses det = Dxx Dyy - (0.9 Dxy)^2 at x = begin, begin + step, ..., `count` of them, with the
/// derivatives divided by the filter's area and by 255 (intensities in [0, 1]). `differences` must cover
/// begin - half .. last + half + 1.
void hessianRow(const ColumnDifferences& differences, const BoxFilter& filter, int begin, int step, int count,
                float* responses) noexcept;

/// The same with a step of 1 where a response may reach `threshold`, kBelowThreshold where it cannot because
/// Dxx Dyy does not: there Dxy, which can only lower it, is never computed. It is taken from `rows`;
/// `differences` need not have it. Which responses below the threshold are computed all the same is left
/// open. Returns how many were computed.
int hessianRowAbove(const FilterRows& rows, const ColumnDifferences& differences, const BoxFilter& filter,
                    int begin, int count, float threshold, float* responses) noexcept;

/// The same without column differences, which are kept in `differences` or not at all. Up to
/// IntegralImage::kReadBeyond columns behind the last one of `rows` may be read.
int filterRowAbove(const FilterRows& rows, const BoxFilter& filter, int begin, int count, float threshold,
                   ColumnDifferences& differences, float* responses) noexcept;

/// to[i] = from[2 i], for `count` of them; `to` may be `from`. from[2 count - 1] may be read.
void everyOther(const float* from, int count, float* to) noexcept;

/// One response: that of hessianRow() at pixel (x, y), where the filter must lie within the image.
float hessianAt(const IntegralImage& integral, const BoxFilter& filter, int x, int y) noexcept;

}  // namespace perennial
