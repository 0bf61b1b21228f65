#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace perennial {

/// Errors of one run, by what was registered. A missing answer is NaN.
struct RunErrors {
  std::string name;
  std::vector<std::string> keys;  ///< one for each registration, unique
  std::vector<double> errors_px;  ///< absolute
};

/// Reads a run's errors.csv. Throws DatasetError naming file and line.
RunErrors loadRunErrors(const std::string& folder, const std::string& name);

/// A paired t-test between two runs over what both answered, two-sided.
struct PairedComparison {
  std::string a;
  std::string b;
  std::size_t pairs = 0;
  std::size_t missing_a = 0;        ///< answered by b only
  std::size_t missing_b = 0;        ///< answered by a only
  std::size_t missing_both = 0;     ///< answered by neither, or not registered by one of them
  double mean_difference_px = 0.0;  ///< of a's absolute error less b's: negative where a is better
  double low_px = 0.0;              ///< 95 % interval of it
  double high_px = 0.0;
  double t = 0.0;
  double p = 1.0;       ///< of a difference as large by chance
  double p_holm = 1.0;  ///< with Holm's correction for all comparisons made together
};

/// One comparison. With fewer than two pairs, or where all differences are equal, p is 1 if they are zero,
/// else 0.
PairedComparison comparePaired(const RunErrors& a, const RunErrors& b);

/// Every run with every other, with Holm's correction (Scandinavian Journal of Statistics 1979).
std::vector<PairedComparison> compareAll(const std::vector<RunErrors>& runs);

/// Holm's step-down correction of p-values, in their order.
std::vector<double> holmCorrected(const std::vector<double>& p);

}  // namespace perennial
