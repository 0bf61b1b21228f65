#include "perennial/evaluation/replay_input.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>

#include "perennial/core/error.h"
#include "perennial/core/reference_map.h"
#include "perennial/evaluation/parallel.h"

namespace perennial {
namespace {

double threadMilliseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

CachedFeatures stored(const Dataset& dataset, const DatasetRow& row, const std::string& content) {
  if (row.line != 0) {
    throw DatasetError(dataset.at(row) +
                       "an image stores no features; only local maps of the reference system do");
  }
  const ReferenceLocalMap map = decodeReferenceMap(content, row.image);
  return {std::make_shared<FeatureSet>(map.features), map.image.cols, map.image.rows, 0.0};
}

CachedFeatures extracted(const cv::Mat& image, const ExtractionSettings& settings) {
  // One extractor for each thread: its buffers are worth keeping.
  thread_local std::optional<FeatureExtractor> extractor;
  if (!extractor || extractor->settings().describe() != settings.describe()) {
    extractor.emplace(settings);
  }
  const double start_ms = threadMilliseconds();
  CachedFeatures result{std::make_shared<FeatureSet>(extractor->extract(image)), image.cols, image.rows, 0.0};
  result.extraction_ms = threadMilliseconds() - start_ms;
  return result;
}

CachedFeatures featuresOf(const Dataset& dataset, const DatasetRow& row, const FeatureSource& source,
                          const FeatureCache& cache) {
  const std::string content = dataset.readFile(row);
  if (auto known = cache.find(content, source.describe())) {
    return *known;
  }
  const CachedFeatures features = source.stored
                                      ? stored(dataset, row, content)
                                      : extracted(dataset.decodeImage(row, content), source.extraction);
  cache.store(content, source.describe(), features);
  return features;
}

bool inRange(const DatasetRow& row, const ReplaySelection& selection) {
  return (selection.from.empty() || row.traversal >= selection.from) &&
         (selection.to.empty() || row.traversal <= selection.to);
}

}  // namespace

std::vector<SelectedPlace> selectPlaces(const Dataset& dataset, const ReplaySelection& selection,
                                        std::vector<std::string>& problems) {
  std::vector<SelectedPlace> places;
  for (const auto& [distance_m, rows] : dataset.places()) {
    const auto taught = std::find_if(rows.begin(), rows.end(), [&](const DatasetRow& row) {
      return selection.teach.empty() || row.traversal == selection.teach;
    });
    if (taught == rows.end()) {
      problems.push_back(dataset.at(rows.front()) + "the place at " + std::to_string(distance_m) +
                         " m has no map: traversal '" + selection.teach + "' was not there");
      continue;
    }
    SelectedPlace place;
    place.rows.push_back(*taught);
    std::copy_if(std::next(taught), rows.end(), std::back_inserter(place.rows),
                 [&](const DatasetRow& row) { return inRange(row, selection); });
    if (place.rows.size() == 1) {
      problems.push_back(dataset.at(*taught) + "the place at " + std::to_string(distance_m) +
                         " m has nothing to register after it was taught");
      continue;
    }
    places.push_back(std::move(place));
  }
  return places;
}

ReplayInput loadReplayInput(const Dataset& dataset, const std::vector<SelectedPlace>& places,
                            const FeatureSource& source, const FeatureCache& cache, unsigned threads,
                            std::vector<std::string>& problems,
                            const std::function<void(std::size_t)>& progress) {
  std::vector<std::pair<std::size_t, std::size_t>> images;  // place, row
  std::vector<std::vector<std::optional<CachedFeatures>>> features(places.size());
  for (std::size_t p = 0; p < places.size(); ++p) {
    features[p].resize(places[p].rows.size());
    for (std::size_t r = 0; r < places[p].rows.size(); ++r) {
      images.emplace_back(p, r);
    }
  }
  std::mutex mutex;
  std::size_t done = 0;
  parallelFor(images.size(), threads, [&](std::size_t i) {
    const auto [p, r] = images[i];
    std::string problem;
    try {
      features[p][r] = featuresOf(dataset, places[p].rows[r], source, cache);
    } catch (const DatasetError& error) {
      problem = error.what();
    }
    const std::lock_guard<std::mutex> lock(mutex);
    if (!problem.empty()) {
      problems.push_back(problem);
    }
    progress(++done);
  });

  ReplayInput input;
  double extraction_ms = 0.0;
  std::size_t extracted = 0;
  for (std::size_t p = 0; p < places.size(); ++p) {
    if (!features[p][0]) {
      problems.push_back(dataset.at(places[p].rows[0]) +
                         "the whole place is left out, since its map is missing");
      continue;
    }
    const CachedFeatures& taught = *features[p][0];
    ReplayPlace place;
    place.index = static_cast<std::uint32_t>(input.places.size());
    place.distance_m = places[p].rows[0].distance_m;
    place.taught = {taught.features, places[p].rows[0].stamp_s};
    std::vector<DatasetRow> rows;
    for (std::size_t r = 0; r < places[p].rows.size(); ++r) {
      const auto& view = features[p][r];
      if (!view) {
        continue;
      }
      extraction_ms += view->extraction_ms;
      ++extracted;
      if (view->image_width != taught.image_width || view->image_height != taught.image_height) {
        problems.push_back(dataset.at(places[p].rows[r]) +
                           "the image has another size than the first one of its place");
      } else if (r > 0) {
        place.views.push_back({view->features, places[p].rows[r].stamp_s});
        rows.push_back(places[p].rows[r]);
      }
    }
    input.places.push_back(std::move(place));
    input.rows.push_back(std::move(rows));
    input.taught.push_back(places[p].rows[0]);
  }
  input.ms_per_extraction = extracted > 0 ? extraction_ms / static_cast<double>(extracted) : 0.0;
  return input;
}

void repeatViews(ReplayInput& input, std::size_t count) {
  constexpr double kDay_s = 86400.0;
  for (std::size_t p = 0; p < input.places.size(); ++p) {
    std::vector<ReplayView>& views = input.places[p].views;
    std::vector<DatasetRow>& rows = input.rows[p];
    const std::size_t once = views.size();
    if (once == 0 || once >= count) {
      continue;
    }
    const double round_s =
        kDay_s * (std::floor((views.back().stamp_s - views.front().stamp_s) / kDay_s) + 1.0);
    views.reserve(count);
    for (std::size_t v = 0; v < count; ++v) {
      const std::size_t round = v / once;
      if (round > 0) {
        views.push_back(views[v % once]);
        rows.push_back(rows[v % once]);
        views[v].stamp_s += round_s * static_cast<double>(round);
        rows[v].stamp_s = views[v].stamp_s;
      }
    }
    for (std::size_t v = 0; v < count; ++v) {
      const std::string round = std::to_string(v / once);
      rows[v].traversal =
          std::string(round.size() < 4 ? 4 - round.size() : 0, '0') + round + "_" + rows[v].traversal;
    }
  }
}

}  // namespace perennial
