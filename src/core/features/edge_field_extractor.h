#pragma once

#include <opencv2/core.hpp>

#include "core/features/orientation_image.h"
#include "perennial/core/edge_field.h"

namespace perennial {

/// Computes edge fields from gradients over two distances: the mean of the orientations (see
/// OrientationImages) at half a cell, four to a cell, and the orientation at a whole cell are added. The
/// finer ones tell trunks apart, the coarser ones houses. One instance serves one thread.
class EdgeFieldExtractor {
 public:
  /// `half`: the image at half its size as halveImage() gives it, CV_8UC1, may be empty or too small for a
  /// single cell (the field is then empty). Memory is kept and used again.
  void compute(const cv::Mat& half, EdgeField& field);

 private:
  void shrink(const cv::Mat& half, EdgeField& field);
  void addOrientations(EdgeField& field);

  cv::Mat spare_;
  cv::Mat fine_image_;    ///< of half a cell a pixel
  cv::Mat coarse_image_;  ///< of a cell a pixel
  OrientationImages fine_;
  OrientationImages coarse_;
  std::vector<int> row_;  ///< one component of one row of cells, in quarters of a level
};

/// Of a whole image (CV_8UC1).
EdgeField edgeFieldOf(const cv::Mat& image);

}  // namespace perennial
