#pragma once

#include <vector>

#include "perennial/core/dataset.h"
#include "perennial/core/odometer.h"

namespace perennial {

/// A traversal of a data set as a robot would have driven it: odometry for images that come without.
struct DatasetTrack {
  std::vector<double> image_stamps_s;  ///< of each row
  std::vector<OdometrySample>
      odometry;                  ///< a straight drive along x; one sample at exactly each image's stamp
  bool stamps_replaced = false;  ///< whether the rows' own stamps could not be used
};

/// `rows`: one traversal by distance, as Dataset::traversal() gives them. x is the distance. The rows' stamps
/// are kept where they rise with the distance and no stretch is driven slower than 1 cm/s; otherwise time
/// runs from the first stamp at `speed_m_s`. Samples are at most 0.05 m apart. Throws DatasetError for no
/// rows.
DatasetTrack trackOf(const std::vector<DatasetRow>& rows, double speed_m_s);

}  // namespace perennial
