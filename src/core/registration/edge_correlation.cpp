#include "core/registration/edge_correlation.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/simd/kernels.h"

namespace perennial {
namespace {

std::size_t roundedUp(std::size_t count) {
  return (count + kProductBlock - 1) / kProductBlock * kProductBlock;
}

}  // namespace

std::int32_t productSum(const std::int16_t* a, const std::int16_t* b, std::size_t stride, std::size_t rows,
                        std::size_t count) noexcept {
  std::int32_t sum = 0;
  for (std::size_t y = 0; y < rows; ++y) {
    for (std::size_t x = 0; x < count; ++x) {
      sum += a[y * stride + x] * b[y * stride + x];
    }
  }
  return sum;
}

bool EdgeCorrelation::compute(const EdgeField& map, const EdgeField& view) {
  if (map.empty() || !map.fits(view)) {
    return false;
  }
  stride_ = roundedUp(2 * static_cast<std::size_t>(map.columns)) + kProductBlock;
  widen(map, map_);
  widen(view, view_);
  if (map_.norm == 0.0 || view_.norm == 0.0) {
    return false;
  }
  reach_x_ = map.columns / 2;
  reach_y_ = std::min(kVertical_px / map.cell_px, map.rows / 2);
  step_px_ = map.cell_px;
  correlate(map);
  reduce();
  return true;
}

void EdgeCorrelation::widen(const EdgeField& field, Wide& wide) const {
  const std::size_t count = 2 * static_cast<std::size_t>(field.columns);
  const auto rows = static_cast<std::size_t>(field.rows);
  // One block more: a row that is read from its middle on ends in the next one's.
  wide.values.assign(rows * stride_ + kProductBlock, 0);
  for (std::size_t y = 0; y < rows; ++y) {
    const auto* const row = field.values.data() + y * count;
    std::copy(row, row + count, wide.values.begin() + static_cast<std::ptrdiff_t>(y * stride_));
  }
  const std::int16_t* const values = wide.values.data();
  wide.norm =
      std::sqrt(static_cast<double>(kernels().product_sum(values, values, stride_, rows, roundedUp(count))));
}

double EdgeCorrelation::shifted(const EdgeField& layout, int dx, int dy) const {
  const auto columns = static_cast<std::size_t>(layout.columns - std::abs(dx));
  const auto rows = static_cast<std::size_t>(layout.rows - std::abs(dy));
  const auto place = [&](int x, int y) {
    return static_cast<std::size_t>(std::max(y, 0)) * stride_ + 2 * static_cast<std::size_t>(std::max(x, 0));
  };
  const std::int32_t sum =
      kernels().product_sum(map_.values.data() + place(dx, dy), view_.values.data() + place(-dx, -dy),
                            stride_, rows, roundedUp(2 * columns));
  return sum / std::sqrt(static_cast<double>(columns * rows));
}

void EdgeCorrelation::correlate(const EdgeField& layout) {
  table_.clear();
  const double scale = layout.columns * layout.rows / (map_.norm * view_.norm);
  for (int dy = -reach_y_; dy <= reach_y_; ++dy) {
    for (int dx = -reach_x_; dx <= reach_x_; ++dx) {
      table_.push_back(scale * shifted(layout, dx, dy));
    }
  }
}

void EdgeCorrelation::reduce() {
  const auto columns = static_cast<std::size_t>(2 * reach_x_ + 1);
  const auto rows = static_cast<std::size_t>(2 * reach_y_ + 1);
  smoothed_.resize(columns);
  profile_.assign(columns, -1e30);
  for (std::size_t y = 0; y < rows; ++y) {
    const double* const here = table_.data() + y * columns;
    const double* const above = y > 0 ? here - columns : here;
    const double* const below = y + 1 < rows ? here + columns : here;
    for (std::size_t x = 0; x < columns; ++x) {
      smoothed_[x] = (above[x] + below[x]) + 2.0 * here[x];
    }
    for (std::size_t x = 0; x < columns; ++x) {
      const double before = smoothed_[x > 0 ? x - 1 : x];
      const double after = smoothed_[x + 1 < columns ? x + 1 : x];
      profile_[x] = std::max(profile_[x], ((before + after) + 2.0 * smoothed_[x]) / 16.0);
    }
  }
  sorted_ = profile_;
  const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(columns / 2);
  std::nth_element(sorted_.begin(), middle, sorted_.end());
  for (double& value : profile_) {
    value -= *middle;
  }
}

double EdgeCorrelation::at(double displacement_px) const {
  const double place = displacement_px / step_px_ + reach_x_;
  if (place < 0.0 || place > 2.0 * reach_x_) {
    return 0.0;
  }
  const auto before = std::min(static_cast<std::size_t>(place), profile_.size() - 1);
  const std::size_t after = std::min(before + 1, profile_.size() - 1);
  const double share = place - static_cast<double>(before);
  return (1.0 - share) * profile_[before] + share * profile_[after];
}

}  // namespace perennial
