#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perennial {

/// Which way the edges run in every part of an image: the image in square cells, each with the mean cosine
/// and sine of twice the gradient's angle (an edge from dark to bright counts as one from bright to dark),
/// less the mean of its row of cells. Evidence for registration that needs no features: snow and searchlights
/// change what a feature looks like, trunks and houses go on standing upright in the same places.
///
/// Cells are 8 px wide, or as many times twice that as it takes for at most 128 columns and rows.
struct EdgeField {
  static constexpr int kMostCells = 128;  ///< columns or rows

  int cell_px = 0;  ///< width and height of a cell
  int columns = 0;
  int rows = 0;
  std::vector<std::int8_t> values;  ///< row by row, cosine and sine of one cell after the other, -127..127

  bool empty() const { return values.empty(); }
  /// Whether the numbers agree with each other, for fields that come from elsewhere.
  bool sound() const {
    const auto within = [](int count) { return count >= 0 && count <= kMostCells; };
    return within(columns) && within(rows) && (empty() || cell_px > 0) &&
           values.size() == 2 * static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows) &&
           std::find(values.begin(), values.end(), std::int8_t{-128}) == values.end();
  }
  void clear() {
    cell_px = columns = rows = 0;
    values.clear();
  }
  /// Whether cells of the one can be laid over cells of the other.
  bool fits(const EdgeField& other) const {
    return cell_px == other.cell_px && columns == other.columns && rows == other.rows;
  }
  bool operator==(const EdgeField& other) const { return fits(other) && values == other.values; }
};

}  // namespace perennial
