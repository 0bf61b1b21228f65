#include "core/features/box_hessian.h"

namespace perennial {
namespace {

float signedSum(std::uint32_t modular) { return static_cast<float>(static_cast<std::int32_t>(modular)); }

/// One response, from pointers into the differences at its centre column. Inlined into both loops below.
struct Response {
  int lobe;
  int half;
  int half_lobe;
  float norm;

  float operator()(const std::uint32_t* xx, const std::uint32_t* yy, const std::uint32_t* xy) const noexcept {
    const std::uint32_t sum_xx = (xx[half + 1] - xx[-half]) - 3U * (xx[half_lobe + 1] - xx[-half_lobe]);
    const std::uint32_t sum_yy = yy[lobe] - yy[1 - lobe];
    const std::uint32_t sum_xy = (xy[0] - xy[-lobe]) - (xy[lobe + 1] - xy[1]);
    const float dxx = signedSum(sum_xx) * norm;
    const float dyy = signedSum(sum_yy) * norm;
    const float dxy = signedSum(sum_xy) * norm;
    return dxx * dyy - kMixedWeight * dxy * dxy;
  }
};

}  // namespace

void ColumnDifferences::resize(std::size_t columns) {
  xx.resize(columns);
  yy.resize(columns);
  xy.resize(columns);
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

void differenceColumns(const FilterRows& rows, int begin, int end, ColumnDifferences& differences) noexcept {
  // Local pointers and one loop per derivative: so the compiler sees that nothing overlaps, and vectorises.
  std::uint32_t* const __restrict xx = differences.xx.data();
  std::uint32_t* const __restrict yy = differences.yy.data();
  std::uint32_t* const __restrict xy = differences.xy.data();
  const auto [xx0, xx1] = rows.xx;
  for (int x = begin; x < end; ++x) {
    xx[x] = xx1[x] - xx0[x];
  }
  const auto [yy0, yy1, yy2, yy3] = rows.yy;
  for (int x = begin; x < end; ++x) {
    yy[x] = (yy3[x] - yy0[x]) - 3U * (yy2[x] - yy1[x]);
  }
  const auto [xy0, xy1, xy2, xy3] = rows.xy;
  for (int x = begin; x < end; ++x) {
    xy[x] = (xy1[x] - xy0[x]) - (xy3[x] - xy2[x]);
  }
}

void hessianRow(const ColumnDifferences& differences, const BoxFilter& filter, int begin, int step, int count,
                float* __restrict responses) noexcept {
  const Response response{filter.lobe, filter.half(), filter.lobe / 2, responseNorm(filter)};
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

}  // namespace perennial
