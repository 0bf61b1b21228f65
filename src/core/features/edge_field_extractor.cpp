#include "core/features/edge_field_extractor.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>

#include "core/features/half_image.h"

namespace perennial {
namespace {

constexpr int kSmallestCell_px = 8;
constexpr int kMiddle = 128;  // of OrientationImages

/// In sixteenths, rounded half up; an orientation at either scale counts up to 127, a cell is stored in a
/// quarter of that.
std::int8_t stored(int quarters) {
  constexpr int kOffset = 16 * 256;
  const int rounded = (quarters + kOffset + 8) / 16 - 256;
  return static_cast<std::int8_t>(std::clamp(rounded, -127, 127));
}

/// One component of one row of cells: four fine places and a coarse one each.
void sumRow(const cv::Mat& fine, const cv::Mat& coarse, int y, std::vector<int>& row) {
  const std::uint8_t* const upper = fine.ptr<std::uint8_t>(2 * y);
  const std::uint8_t* const lower = fine.ptr<std::uint8_t>(2 * y + 1);
  const std::uint8_t* const whole = coarse.ptr<std::uint8_t>(y);
  for (std::size_t x = 0; x < row.size(); ++x) {
    row[x] = upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1] + 4 * whole[x] - 8 * kMiddle;
  }
}

}  // namespace

void EdgeFieldExtractor::compute(const cv::Mat& half, EdgeField& field) {
  shrink(half, field);
  if (coarse_image_.empty()) {
    field.clear();
    return;
  }
  fine_.compute(fine_image_);
  coarse_.compute(coarse_image_);
  addOrientations(field);
}

void EdgeFieldExtractor::shrink(const cv::Mat& half, EdgeField& field) {
  halveImage(half, fine_image_);
  field.cell_px = kSmallestCell_px;
  while (std::max(fine_image_.cols, fine_image_.rows) / 2 > EdgeField::kMostCells) {
    halveImage(fine_image_, spare_);
    std::swap(fine_image_, spare_);
    field.cell_px *= 2;
  }
  halveImage(fine_image_, coarse_image_);
}

void EdgeFieldExtractor::addOrientations(EdgeField& field) {
  field.columns = coarse_image_.cols;
  field.rows = coarse_image_.rows;
  const auto columns = static_cast<std::size_t>(field.columns);
  field.values.resize(2 * columns * static_cast<std::size_t>(field.rows));
  row_.resize(columns);
  for (int y = 0; y < field.rows; ++y) {
    std::int8_t* const cells = field.values.data() + 2 * columns * static_cast<std::size_t>(y);
    for (const bool sine : {false, true}) {
      sumRow(sine ? fine_.sine() : fine_.cosine(), sine ? coarse_.sine() : coarse_.cosine(), y, row_);
      const int mean = std::accumulate(row_.begin(), row_.end(), 0) / field.columns;
      for (std::size_t x = 0; x < columns; ++x) {
        cells[2 * x + (sine ? 1 : 0)] = stored(row_[x] - mean);
      }
    }
  }
}

EdgeField edgeFieldOf(const cv::Mat& image) {
  cv::Mat half;
  halveImage(image, half);
  EdgeField field;
  EdgeFieldExtractor().compute(half, field);
  return field;
}

}  // namespace perennial
