#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "perennial/core/dataset.h"
#include "perennial/core/evaluation/disturbance.h"
#include "perennial/core/feature_extractor.h"
#include "perennial/core/registration.h"

namespace perennial {

/// Two images of one place, the earlier one taken as the map, and what registering them gave.
struct PairRecord {
  DatasetRow map;
  DatasetRow view;
  std::size_t map_features = 0;
  std::optional<double> displacement_px;
  int inliers = 0;
  int matches = 0;
  double confidence = 0.0;
  double uncertainty_px = 0.0;

  double groundTruth() const { return groundTruthDisplacement(map, view); }
  /// Signed: what was found less what should have been.
  std::optional<double> error() const {
    return displacement_px ? std::make_optional(*displacement_px - groundTruth()) : std::nullopt;
  }
};

struct PairsSettings {
  ExtractionSettings extraction;
  RegistrationSettings registration;
  std::optional<Disturbance> disturbance;  ///< of every view, not of the maps
};

struct PairsEvaluation {
  std::vector<PairRecord> records;  ///< by place, then map, then view
  double ms_per_extraction = 0.0;
  double ms_per_registration = 0.0;
};

/// Registers every pair i < j of images of one place, without any map management: the registration by itself.
/// `progress(done, total)`, in images, may be empty. Throws DatasetError for an image that cannot be read.
PairsEvaluation evaluatePairs(const Dataset& dataset, const PairsSettings& settings,
                              const std::function<void(std::size_t, std::size_t)>& progress = {});

/// In figures; errors are absolute ones.
struct PairsSummary {
  std::size_t registrations = 0;
  double answered = 0.0;                          ///< share with a displacement
  std::vector<std::pair<int, double>> within_px;  ///< px, share of ALL pairs
  std::optional<double> mean_error_px;            ///< of the answered ones
  std::optional<double> median_error_px;
  double answered_at_99_precision = 0.0;
};

PairsSummary summarisePairs(const std::vector<PairRecord>& records);

/// The largest share of all pairs that can be answered, the most confident first, so that `precision` of the
/// answers are right within `within_px`. Pairs of equal confidence are answered together or not at all.
double answeredAtPrecision(const std::vector<PairRecord>& records, double precision, double within_px);

/// Writes errors.csv, a line per pair, and summary.json. Creates the folder. Throws Error when it cannot be
/// written. `input`: what was evaluated; `settings`: key and value of what was not by default.
void writePairs(const std::string& folder, const std::string& input,
                const std::vector<std::pair<std::string, std::string>>& settings,
                const PairsEvaluation& evaluation);

}  // namespace perennial
