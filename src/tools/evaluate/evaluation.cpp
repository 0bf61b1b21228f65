#include "tools/evaluate/evaluation.h"

#include <iostream>
#include <map>
#include <utility>

#include "core/map/row_checksum.h"
#include "perennial/evaluation/parallel.h"
#include "perennial/ros/bag_dataset.h"
#include "tools/evaluate/progress.h"

namespace perennial {
namespace {

/// Of everything that the data set says of its images: a data set that was made anew is another input.
std::string fingerprint(const Dataset& dataset) {
  RowChecksum checksum;
  for (const DatasetRow& row : dataset.rows) {
    checksum.add(row.traversal).add(row.stamp_s).add(row.distance_m).add(row.image).add(row.offset_px);
  }
  return std::to_string(checksum.value());
}

}  // namespace

bool Evaluation::run() {
  const std::vector<RunSettings> runs = checkedRuns();
  const Dataset dataset = loadDataset(inputFolder());
  const std::vector<SelectedPlace> places = selectPlaces(dataset, options_.selection, problems_);
  std::map<std::string, std::vector<RunSettings>> by_extraction;
  for (const RunSettings& run : runs) {
    if (!isComplete(folderOf(run), run, inputName(dataset))) {
      by_extraction[run.extraction().describe()].push_back(run);
    }
  }
  for (const auto& group : by_extraction) {
    runAll(dataset, places, group.second);
  }
  for (const std::string& problem : problems_) {
    std::cerr << "evaluate: " << problem << "\n";
  }
  return problems_.empty();
}

std::string Evaluation::inputFolder() {
  if (options_.bags.empty()) {
    return options_.dataset;
  }
  const std::string folder = options_.out + "/dataset";
  writeBagDataset(options_.bags, options_.image_topic, options_.ground_truth, folder, problems_);
  return folder;
}

std::vector<RunSettings> Evaluation::checkedRuns() {
  std::vector<RunSettings> runs;
  if (!options_.sweep.empty()) {
    runs = loadSweep(options_.sweep, options_.assignments);
  } else {
    runs.emplace_back(options_.strategy);
    for (const std::string& assignment : options_.assignments) {
      runs.back().set(assignment);
    }
  }
  for (const RunSettings& run : runs) {
    create(run);
    run.registration();
    run.extraction();
    run.learningGate();
  }
  return runs;
}

std::shared_ptr<MapStrategy> Evaluation::create(const RunSettings& run) {
  const std::lock_guard<std::mutex> lock(loader_mutex_);
  auto strategy = loader_.load(run.strategy());
  ParameterReader reader = run.strategyReader();
  strategy->configure(reader);
  reader.requireAllUsed();
  return strategy;
}

std::string Evaluation::folderOf(const RunSettings& run) const {
  return options_.sweep.empty() ? options_.out : options_.out + "/" + run.name();
}

std::string Evaluation::inputName(const Dataset& dataset) const {
  return dataset.manifest + " (" + std::to_string(dataset.rows.size()) + " images, checksum " +
         fingerprint(dataset) + ") teach=" + options_.selection.teach + " from=" + options_.selection.from +
         " to=" + options_.selection.to + " skip_first=" + std::to_string(options_.skip_first) +
         (options_.repeat > 0 ? " repeat=" + std::to_string(options_.repeat) : "") +
         (options_.stored_features ? " stored features" : "");
}

void Evaluation::runAll(const Dataset& dataset, const std::vector<SelectedPlace>& places,
                        const std::vector<RunSettings>& runs) {
  std::size_t images = 0;
  for (const SelectedPlace& place : places) {
    images += place.rows.size();
  }
  Progress extracting("features of images", images);
  ReplayInput input =
      loadReplayInput(dataset, places, {runs.front().extraction(), options_.stored_features}, cache_,
                      options_.threads, problems_, [&](std::size_t done) { extracting.show(done); });
  repeatViews(input, options_.repeat);

  Progress replaying(std::to_string(runs.size()) + " runs", runs.size() * input.places.size());
  std::vector<std::vector<PlaceReplayResult>> results(runs.size(),
                                                      std::vector<PlaceReplayResult>(input.places.size()));
  std::vector<std::size_t> places_done(runs.size(), 0);
  std::size_t done = 0;
  std::mutex mutex;
  parallelFor(runs.size() * input.places.size(), options_.threads, [&](std::size_t job) {
    const std::size_t r = job / input.places.size();
    const std::size_t p = job % input.places.size();
    const auto strategy = create(runs[r]);
    results[r][p] = replayPlace(input.places[p], *strategy, runs[r].registration(), runs[r].learningGate());
    const std::lock_guard<std::mutex> lock(mutex);
    replaying.show(++done);
    if (++places_done[r] == input.places.size()) {
      write(runs[r], input, results[r], inputName(dataset));
      results[r].clear();
    }
  });
}

void Evaluation::write(const RunSettings& run, const ReplayInput& input,
                       const std::vector<PlaceReplayResult>& places, const std::string& name) const {
  RunOutput output;
  output.input = name;
  output.records = recordsOf(input, places, options_.skip_first);
  for (const PlaceReplayResult& place : places) {
    output.lives.add(place.lives);
  }
  output.costs = costsOf(places);
  output.ms_per_extraction = input.ms_per_extraction;
  writeRun(folderOf(run), run, output);
}

}  // namespace perennial
