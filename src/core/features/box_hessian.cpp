#include "core/features/box_hessian.h"

namespace perennial {
namespace {

float signedSum(std::uint32_t modular) { return static_cast<float>(static_cast<std::int32_t>(modular)); }

/// Derivatives at one pixel, from pointers into the column differences there. Inlined into the loops below.
struct Response {
  int lobe;
  int half;
  int half_lobe;
  float norm;

  explicit Response(const BoxFilter& filter)
      : lobe(filter.lobe), half(filter.half()), half_lobe(filter.lobe / 2), norm(responseNorm(filter)) {}

  float dxx(const std::uint32_t* xx) const noexcept {
    return signedSum((xx[half + 1] - xx[-half]) - 3U * (xx[half_lobe + 1] - xx[-half_lobe])) * norm;
  }
  float dyy(const std::uint32_t* yy) const noexcept { return signedSum(yy[lobe] - yy[1 - lobe]) * norm; }
  float dxy(const std::uint32_t* xy) const noexcept {
    return signedSum((xy[0] - xy[-lobe]) - (xy[lobe + 1] - xy[1])) * norm;
  }
  /// Dxy from the image's rows.
  float dxy(const FilterRows& rows, int x) const noexcept {
    const auto column = [&](int at) {
      return (rows.xy[1][at] - rows.xy[0][at]) - (rows.xy[3][at] - rows.xy[2][at]);
    };
    return signedSum((column(x) - column(x - lobe)) - (column(x + lobe + 1) - column(x + 1))) * norm;
  }

  static float determinant(float dxx, float dyy, float dxy) noexcept {
    return dxx * dyy - kMixedWeight * dxy * dxy;
  }

  float operator()(const std::uint32_t* xx, const std::uint32_t* yy, const std::uint32_t* xy) const noexcept {
    return determinant(dxx(xx), dyy(yy), dxy(xy));
  }
};

}  // namespace

void ColumnDifferences::resize(std::size_t columns) {
  const std::size_t size = wholeLines<std::uint32_t>(columns);
  xx.resize(size);
  yy.resize(size);
  xy.resize(size);
}

FilterRows::FilterRows(const IntegralImage& integral, const BoxFilter& filter, int y) {
  const int lobe = filter.lobe;
  const int half = filter.half();
  xx[0] = integral.row(y - lobe + 1);
  xx[1] = integral.row(y + lobe);
  yy[0] = integral.row(y - half);
  yy[1] = integral.row(y - lobe / 2);
  yy[2] = integral.row(y + lobe / 2 + 1);
  yy[3] = integral.row(y + half + 1);
  xy[0] = integral.row(y - lobe);
  xy[1] = integral.row(y);
  xy[2] = integral.row(y + 1);
  xy[3] = integral.row(y + lobe + 1);
}

void differenceColumnsXxYy(const FilterRows& rows, int begin, int end,
                           ColumnDifferences& differences) noexcept {
  // Local pointers and one loop per derivative: so the compiler sees that nothing overlaps, and vectorises.
  std::uint32_t* const __restrict xx = differences.xx.data();
  std::uint32_t* const __restrict yy = differences.yy.data();
  const auto [xx0, xx1] = rows.xx;
  for (int x = begin; x < end; ++x) {
    xx[x] = xx1[x] - xx0[x];
  }
  const auto [yy0, yy1, yy2, yy3] = rows.yy;
  for (int x = begin; x < end; ++x) {
    yy[x] = (yy3[x] - yy0[x]) - 3U * (yy2[x] - yy1[x]);
  }
}

void differenceColumns(const FilterRows& rows, int begin, int end, ColumnDifferences& differences) noexcept {
  differenceColumnsXxYy(rows, begin, end, differences);
  std::uint32_t* const __restrict xy = differences.xy.data();
  const auto [xy0, xy1, xy2, xy3] = rows.xy;
  for (int x = begin; x < end; ++x) {
    xy[x] = (xy1[x] - xy0[x]) - (xy3[x] - xy2[x]);
  }
}

void hessianRow(const ColumnDifferences& differences, const BoxFilter& filter, int begin, int step, int count,
                float* __restrict responses) noexcept {
  const Response response(filter);
  const std::uint32_t* const xx = differences.xx.data() + begin;
  const std::uint32_t* const yy = differences.yy.data() + begin;
  const std::uint32_t* const xy = differences.xy.data() + begin;
  if (step == 1) {  // a loop of its own: only unit steps are vectorised
    for (int i = 0; i < count; ++i) {
      responses[i] = response(xx + i, yy + i, xy + i);
    }
    return;
  }
  for (int i = 0; i < count; ++i) {
    responses[i] = response(xx + i * step, yy + i * step, xy + i * step);
  }
}

int hessianRowAbove(const FilterRows& rows, const ColumnDifferences& differences, const BoxFilter& filter,
                    int begin, int count, float threshold, float* __restrict responses) noexcept {
  const Response response(filter);
  const std::uint32_t* const xx = differences.xx.data() + begin;
  const std::uint32_t* const yy = differences.yy.data() + begin;
  int computed = 0;
  for (int i = 0; i < count; ++i) {
    const float dxx = response.dxx(xx + i);
    const float dyy = response.dyy(yy + i);
    const bool may_reach = dxx * dyy >= threshold;
    responses[i] =
        may_reach ? Response::determinant(dxx, dyy, response.dxy(rows, begin + i)) : kBelowThreshold;
    computed += may_reach ? 1 : 0;
  }
  return computed;
}

int filterRowAbove(const FilterRows& rows, const BoxFilter& filter, int begin, int count, float threshold,
                   ColumnDifferences& differences, float* responses) noexcept {
  differenceColumnsXxYy(rows, begin - filter.half(), begin + count + filter.half() + 1, differences);
  return hessianRowAbove(rows, differences, filter, begin, count, threshold, responses);
}

void everyOther(const float* from, int count, float* to) noexcept {
  for (int i = 0; i < count; ++i) {
    to[i] = from[2 * i];
  }
}

float hessianAt(const IntegralImage& integral, const BoxFilter& filter, int x, int y) noexcept {
  const Response response(filter);
  const FilterRows rows(integral, filter, y);
  const auto xx = [&](int at) { return rows.xx[1][at] - rows.xx[0][at]; };
  const auto yy = [&](int at) {
    return (rows.yy[3][at] - rows.yy[0][at]) - 3U * (rows.yy[2][at] - rows.yy[1][at]);
  };
  const int half = filter.half();
  const int half_lobe = filter.lobe / 2;
  const std::uint32_t sum_xx =
      (xx(x + half + 1) - xx(x - half)) - 3U * (xx(x + half_lobe + 1) - xx(x - half_lobe));
  const std::uint32_t sum_yy = yy(x + filter.lobe) - yy(x + 1 - filter.lobe);
  return Response::determinant(signedSum(sum_xx) * response.norm, signedSum(sum_yy) * response.norm,
                               response.dxy(rows, x));
}

}  // namespace perennial
