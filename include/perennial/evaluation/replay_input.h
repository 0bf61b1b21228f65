#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "perennial/core/dataset.h"
#include "perennial/core/feature_extractor.h"
#include "perennial/evaluation/feature_cache.h"
#include "perennial/evaluation/replay.h"

namespace perennial {

/// Which part of a data set is replayed.
struct ReplaySelection {
  std::string teach;  ///< traversal that teaches; empty: the first one of each place
  std::string from;   ///< first and last traversal to register, by name; empty: from the teaching to the end
  std::string to;
};

/// Images of one place: the taught one first.
struct SelectedPlace {
  std::vector<DatasetRow> rows;
};

/// Places in order of distance, those that can be replayed. A place without the teaching traversal, and one
/// with nothing to register, is left out and said so in `problems` ("FILE:LINE: what is wrong").
std::vector<SelectedPlace> selectPlaces(const Dataset& dataset, const ReplaySelection& selection,
                                        std::vector<std::string>& problems);

/// Features of selected images, ready to be replayed.
struct ReplayInput {
  std::vector<ReplayPlace> places;
  std::vector<std::vector<DatasetRow>>
      rows;                        ///< of each place's views: rows[p][v] belongs to places[p].views[v]
  std::vector<DatasetRow> taught;  ///< of each place's teaching
  double ms_per_extraction = 0.0;

  /// x_map - x_view, as it should be found.
  double groundTruth(std::size_t place, std::size_t view) const {
    return groundTruthDisplacement(taught[place], rows[place][view]);
  }
};

/// Where features come from.
struct FeatureSource {
  ExtractionSettings extraction;
  /// The features that are stored in local maps of the reference system, instead of extracting any from their
  /// images. A data set with a manifest has none.
  bool stored = false;

  /// Under what they are cached: equal for equal results.
  std::string describe() const { return stored ? "stored" : extraction.describe(); }
};

/// Reads and extracts all images, in parallel, by way of the cache. An image that cannot be read or differs
/// in size from the taught one is left out, a place whose taught image fails altogether; both are said in
/// `problems`. `progress` is called with the number of images done, from several threads one at a time.
ReplayInput loadReplayInput(const Dataset& dataset, const std::vector<SelectedPlace>& places,
                            const FeatureSource& source, const FeatureCache& cache, unsigned threads,
                            std::vector<std::string>& problems,
                            const std::function<void(std::size_t)>& progress);

/// Repeats the views of each place until there are `count` of them, as if the same days came again: each
/// round is later by whole days, and its number stands before the traversals' names ("0002_name"). Places
/// with as many views keep theirs.
void repeatViews(ReplayInput& input, std::size_t count);

}  // namespace perennial
