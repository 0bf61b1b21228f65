#include "perennial/core/evaluation/pairs_evaluation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numeric>

namespace perennial {
namespace {

constexpr int kThresholds_px[] = {5, 10, 20, 35, 50};
constexpr double kRight_px = 35.0;

/// Runs and times, in ms.
template <class Work>
double timed(Work work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

class PlaceEvaluator {
 public:
  PlaceEvaluator(const Dataset& dataset, const PairsSettings& settings)
      : dataset_(dataset),
        extractor_(settings.extraction),
        registration_(makeRegistration(settings.registration)),
        disturbance_(settings.disturbance) {}

  /// Registers the image against all images of the place before it.
  void add(const DatasetRow& row, std::vector<PairRecord>& records) {
    const cv::Mat image = dataset_.readImage(row);
    FeatureSet map = extract(image);
    const FeatureSet view =
        disturbance_ ? extract(disturbed(image, *disturbance_, static_cast<std::uint64_t>(extractions_)))
                     : map;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      registration_ms_ +=
          timed([&] { registration_->registerInto(features_[i], view, workspace_, result_); });
      ++registrations_;
      records.push_back({rows_[i], row, features_[i].size(), result_.displacement_px, result_.inliers,
                         result_.matches, result_.confidence, result_.uncertainty_px});
    }
    rows_.push_back(row);
    features_.push_back(std::move(map));
  }

  void beginPlace() {
    rows_.clear();
    features_.clear();
  }

  double msPerExtraction() const { return extraction_ms_ / std::max(1, extractions_); }
  double msPerRegistration() const { return registration_ms_ / std::max(1, registrations_); }

 private:
  FeatureSet extract(const cv::Mat& image) {
    FeatureSet features;
    extraction_ms_ += timed([&] { extractor_.extractInto(image, features); });
    ++extractions_;
    return features;
  }

  const Dataset& dataset_;
  FeatureExtractor extractor_;
  std::unique_ptr<Registration> registration_;
  std::optional<Disturbance> disturbance_;
  RegistrationWorkspace workspace_;
  RegistrationResult result_;
  std::vector<DatasetRow> rows_;
  std::vector<FeatureSet> features_;
  double extraction_ms_ = 0.0;
  double registration_ms_ = 0.0;
  int extractions_ = 0;
  int registrations_ = 0;
};

}  // namespace

PairsEvaluation evaluatePairs(const Dataset& dataset, const PairsSettings& settings,
                              const std::function<void(std::size_t, std::size_t)>& progress) {
  PairsEvaluation evaluation;
  PlaceEvaluator evaluator(dataset, settings);
  std::size_t done = 0;
  for (const auto& place : dataset.places()) {
    evaluator.beginPlace();
    for (const DatasetRow& row : place.second) {
      evaluator.add(row, evaluation.records);
      if (progress) {
        progress(++done, dataset.rows.size());
      }
    }
  }
  evaluation.ms_per_extraction = evaluator.msPerExtraction();
  evaluation.ms_per_registration = evaluator.msPerRegistration();
  return evaluation;
}

PairsSummary summarisePairs(const std::vector<PairRecord>& records) {
  std::vector<double> errors;
  for (const PairRecord& record : records) {
    if (const auto error = record.error()) {
      errors.push_back(std::abs(*error));
    }
  }
  std::sort(errors.begin(), errors.end());
  PairsSummary summary;
  summary.registrations = records.size();
  const double all = std::max(1.0, static_cast<double>(records.size()));
  summary.answered = static_cast<double>(errors.size()) / all;
  for (const int threshold : kThresholds_px) {
    const auto right = std::upper_bound(errors.begin(), errors.end(), static_cast<double>(threshold));
    summary.within_px.emplace_back(threshold, static_cast<double>(right - errors.begin()) / all);
  }
  summary.answered_at_99_precision = answeredAtPrecision(records, 0.99, kRight_px);
  if (!errors.empty()) {
    const auto answers = static_cast<double>(errors.size());
    summary.mean_error_px = std::accumulate(errors.begin(), errors.end(), 0.0) / answers;
    summary.median_error_px = 0.5 * (errors[(errors.size() - 1) / 2] + errors[errors.size() / 2]);
  }
  return summary;
}

double answeredAtPrecision(const std::vector<PairRecord>& records, double precision, double within_px) {
  std::map<double, std::pair<std::size_t, std::size_t>>
      by_confidence;  // descending: keys negated; answers, right ones
  for (const PairRecord& record : records) {
    if (const auto error = record.error()) {
      auto& [answers, right] = by_confidence[-record.confidence];
      ++answers;
      right += std::abs(*error) <= within_px ? 1 : 0;
    }
  }
  std::size_t answers = 0;
  std::size_t right = 0;
  std::size_t best = 0;
  for (const auto& group : by_confidence) {
    answers += group.second.first;
    right += group.second.second;
    if (static_cast<double>(right) >= precision * static_cast<double>(answers)) {
      best = answers;
    }
  }
  return static_cast<double>(best) / std::max(1.0, static_cast<double>(records.size()));
}

}  // namespace perennial
