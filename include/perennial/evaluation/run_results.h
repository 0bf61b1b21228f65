#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "perennial/evaluation/replay.h"
#include "perennial/evaluation/replay_input.h"
#include "perennial/evaluation/run_settings.h"

namespace perennial {

/// One registration and what it should have found.
struct RegistrationRecord {
  std::string traversal;
  double stamp_s = 0.0;
  double distance_m = 0.0;
  std::optional<double> ground_truth_px;  ///< none where nobody knows, as in a bag without ground truth
  ReplayStep step;

  /// Signed: what was found less what should have been.
  std::optional<double> error() const {
    const bool known = step.displacement_px && ground_truth_px;
    return known ? std::make_optional(*step.displacement_px - *ground_truth_px) : std::nullopt;
  }
};

/// In figures. Errors are absolute ones unless said otherwise; where nothing was answered there is no mean or
/// median.
struct RunSummary {
  std::size_t registrations = 0;
  double answered = 0.0;                          ///< share of the registrations with a displacement
  std::vector<std::pair<int, double>> within_px;  ///< px, share of ALL registrations with a ground truth
  std::optional<double> mean_error_px;
  std::optional<double> median_error_px;
  std::optional<double> mean_signed_error_px;
  double ms_per_registration = 0.0;  ///< NaN where it was not measured
};

RunSummary summarise(const std::vector<RegistrationRecord>& records);

/// Records of a run, by traversal, then distance. The first `skip_first` registrations of each place are left
/// out.
std::vector<RegistrationRecord> recordsOf(const ReplayInput& input,
                                          const std::vector<PlaceReplayResult>& places,
                                          std::size_t skip_first);

/// What the n-th registration of a place costs, as the mean over the places.
struct RegistrationCost {
  std::size_t places = 0;  ///< that were registered so often
  double registration_ms = 0.0;
  double learning_ms = 0.0;
  double map_features = 0.0;
};

/// The cost of the first registration, the second and so on.
std::vector<RegistrationCost> costsOf(const std::vector<PlaceReplayResult>& places);

/// What is written to a run's folder.
struct RunOutput {
  std::string input;  ///< says on what the run was made; the same for the same result
  std::vector<RegistrationRecord> records;
  FeatureLives lives;
  std::vector<RegistrationCost> costs;
  double ms_per_extraction = 0.0;  ///< NaN where it was not measured
};

/// Writes errors.csv, lives.csv (age in traversals, features dropped at it, features still there), cost.csv
/// (of the n-th registration) and, last of all, summary.json, which makes the run complete. Throws Error when
/// the folder cannot be written.
void writeRun(const std::string& folder, const RunSettings& settings, const RunOutput& output);

/// Whether the folder holds a complete run of the same settings on the same input, made by the same version.
bool isComplete(const std::string& folder, const RunSettings& settings, const std::string& input);

}  // namespace perennial
