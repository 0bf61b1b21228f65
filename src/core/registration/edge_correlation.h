#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "perennial/core/edge_field.h"

namespace perennial {

/// How well the edges of a map and a view lie on each other, displacement by displacement.
///
/// Correlation of the two fields over all horizontal shifts that leave half the image in common and vertical
/// ones up to kVertical_px, divided by the root of what overlaps, so that chance is as large everywhere: 1 is
/// the deviation of unrelated cells. Smoothed (1 2 1) along both axes; the best of all vertical shifts
/// counts, less the median over the horizontal ones. The sums are whole numbers: the same on every processor.
class EdgeCorrelation {
 public:
  static constexpr int kVertical_px = 96;

  /// Whether there is any evidence: both fields must be there, of the same layout, and not blank. Memory is
  /// kept and used again.
  bool compute(const EdgeField& map, const EdgeField& view);

  /// From compute() that found any: x_map - x_view in steps of `step()`, odd in number, 0 in the middle.
  const std::vector<double>& profile() const { return profile_; }
  double step_px() const { return step_px_; }
  double reach_px() const { return reach_x_ * step_px_; }

  /// Linear between the steps, 0 beyond the ends.
  double at(double displacement_px) const;

 private:
  /// A field with 16 bits a value and zeros behind each row, for the vector code.
  struct Wide {
    std::vector<std::int16_t> values;
    double norm = 0.0;
  };

  void widen(const EdgeField& field, Wide& wide) const;
  void correlate(const EdgeField& layout);
  double shifted(const EdgeField& layout, int dx, int dy) const;
  void reduce();

  std::size_t stride_ = 0;
  int reach_x_ = 0;
  int reach_y_ = 0;
  Wide map_;
  Wide view_;
  std::vector<double> table_;  ///< rows of vertical shifts
  std::vector<double> smoothed_;
  std::vector<double> profile_;
  std::vector<double> sorted_;
  double step_px_ = 0.0;
};

/// Sum of products over `rows` rows of `count` values, `stride` apart. |values| up to 127.
std::int32_t productSum(const std::int16_t* a, const std::int16_t* b, std::size_t stride, std::size_t rows,
                        std::size_t count) noexcept;

/// Values that follow each row so that `count` may be rounded up to a multiple of this many.
constexpr std::size_t kProductBlock = 32;

}  // namespace perennial
