#include "perennial/evaluation/paired_test.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "perennial/core/csv.h"

namespace perennial {
namespace {

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double standardError(const std::vector<double>& values) {
  const double centre = mean(values);
  double squares = 0.0;
  for (const double value : values) {
    squares += (value - centre) * (value - centre);
  }
  const auto n = static_cast<double>(values.size());
  return std::sqrt(squares / (n - 1.0) / n);
}

void test(PairedComparison& comparison, const std::vector<double>& differences) {
  if (differences.empty()) {
    return;
  }
  comparison.mean_difference_px = mean(differences);
  comparison.low_px = comparison.high_px = comparison.mean_difference_px;
  const double error = differences.size() < 2 ? 0.0 : standardError(differences);
  if (error == 0.0) {
    comparison.p = differences.size() < 2 || comparison.mean_difference_px == 0.0 ? 1.0 : 0.0;
    return;
  }
  const boost::math::students_t distribution(static_cast<double>(differences.size()) - 1.0);
  comparison.t = comparison.mean_difference_px / error;
  comparison.p = 2.0 * boost::math::cdf(boost::math::complement(distribution, std::abs(comparison.t)));
  const double reach = error * boost::math::quantile(distribution, 0.975);
  comparison.low_px -= reach;
  comparison.high_px += reach;
}

}  // namespace

RunErrors loadRunErrors(const std::string& folder, const std::string& name) {
  const CsvTable table = CsvTable::load(folder + "/errors.csv");
  RunErrors run;
  run.name = name;
  const bool of_pairs = table.hasColumn("map_traversal");
  for (const CsvRow& row : table.rows()) {
    run.keys.push_back(table.text(row, "traversal") + "@" + table.text(row, "distance_m") +
                       (of_pairs ? "@" + table.text(row, "map_traversal") : ""));
    const bool answered = !table.text(row, "error_px").empty();
    run.errors_px.push_back(answered ? std::abs(table.number(row, "error_px"))
                                     : std::numeric_limits<double>::quiet_NaN());
  }
  return run;
}

PairedComparison comparePaired(const RunErrors& a, const RunErrors& b) {
  PairedComparison comparison;
  comparison.a = a.name;
  comparison.b = b.name;
  std::map<std::string, double> of_b;
  for (std::size_t i = 0; i < b.keys.size(); ++i) {
    of_b[b.keys[i]] = b.errors_px[i];
  }
  std::vector<double> differences;
  std::size_t shared = 0;
  for (std::size_t i = 0; i < a.keys.size(); ++i) {
    const auto other = of_b.find(a.keys[i]);
    if (other == of_b.end()) {
      ++comparison.missing_both;
      continue;
    }
    ++shared;
    const bool in_a = !std::isnan(a.errors_px[i]);
    const bool in_b = !std::isnan(other->second);
    comparison.missing_a += !in_a && in_b ? 1 : 0;
    comparison.missing_b += in_a && !in_b ? 1 : 0;
    comparison.missing_both += !in_a && !in_b ? 1 : 0;
    if (in_a && in_b) {
      differences.push_back(a.errors_px[i] - other->second);
    }
  }
  comparison.missing_both += b.keys.size() - shared;
  comparison.pairs = differences.size();
  test(comparison, differences);
  return comparison;
}

std::vector<PairedComparison> compareAll(const std::vector<RunErrors>& runs) {
  std::vector<PairedComparison> comparisons;
  std::vector<double> p;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (std::size_t j = i + 1; j < runs.size(); ++j) {
      comparisons.push_back(comparePaired(runs[i], runs[j]));
      p.push_back(comparisons.back().p);
    }
  }
  const std::vector<double> corrected = holmCorrected(p);
  for (std::size_t k = 0; k < comparisons.size(); ++k) {
    comparisons[k].p_holm = corrected[k];
  }
  return comparisons;
}

std::vector<double> holmCorrected(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> corrected(p.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    largest = std::max(largest, std::min(1.0, p[order[k]] * static_cast<double>(order.size() - k)));
    corrected[order[k]] = largest;
  }
  return corrected;
}

}  // namespace perennial
