#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "perennial/core/parameter_reader.h"

namespace perennial {

struct FremenSettings {
  /// Candidate periods, s: the day and its harmonics down to 3 hours, the week, the year.
  std::vector<double> periods_s = {86400.0,       86400.0 / 2.0,   86400.0 / 3.0, 86400.0 / 4.0,
                                   86400.0 / 5.0, 86400.0 / 6.0,   86400.0 / 7.0, 86400.0 / 8.0,
                                   7.0 * 86400.0, 365.25 * 86400.0};
  int order = 2;            ///< how many of the strongest periods a prediction uses; 0: the mean
  int min_samples = 10;     ///< with fewer samples, the mean is predicted
  double min_cycles = 1.5;  ///< a period is a candidate once it fits this many times into what was observed

  /// Keys as the members are called. Throws ParameterError.
  static FremenSettings load(ParameterReader& reader);
};

/// Models a quantity that varies periodically by its mean and the strongest of some candidate periods, from
/// samples at irregular times, one by one, in constant memory (Krajnik et al., "FreMEn: Frequency map
/// enhancement for long-term mobile robot autonomy in changing environments", T-RO 2017; non-uniform
/// version).
///
/// What is known of one quantity is a state of stateSize() doubles, which the caller keeps (a map strategy:
/// among the local map's numbers); all zeros: no samples. Times are seconds from an origin of the caller's
/// choice, the same for all samples of a state, and not too far away: 1e9 s still leaves 1e-7 s. Stateless
/// beside its settings; safe to use from several threads.
class FremenModel {
 public:
  /// exp(j w_k t) of every candidate period at one time: computed once, used for all features.
  using Phases = std::vector<std::complex<double>>;

  explicit FremenModel(const FremenSettings& settings = {});

  std::size_t stateSize() const { return kFixed + kPerPeriod * settings_.periods_s.size(); }
  Phases phases(double time_s) const;

  /// Adds a sample taken at `time_s`; `phases` are those of that time.
  void add(double* state, double time_s, const Phases& phases, double sample) const;

  /// Number of samples.
  static double count(const double* state) { return state[kCount]; }
  /// Mean of the samples; 0 without any.
  static double mean(const double* state) { return state[kCount] > 0.0 ? state[kSum] / state[kCount] : 0.0; }
  /// Greatest sample; 0 without any.
  static double greatest(const double* state) { return state[kGreatest]; }

  /// gamma_k = (A_k - mean B_k) / n. `state` must have a sample.
  std::complex<double> spectrum(const double* state, std::size_t k) const;

  /// The mean plus 2 |gamma_k| cos(w_k t - arg gamma_k) for the `order` strongest candidates, clamped to the
  /// range of the samples. 0 without samples. Of equally strong periods the earlier in the list counts.
  double predict(const double* state, const Phases& phases) const;

  const FremenSettings& settings() const { return settings_; }

 private:
  // State: these, and for every period the real and imaginary parts of A_k = sum s exp(j w_k t) and B_k = sum
  // exp(j w_k t).
  static constexpr std::size_t kCount = 0;
  static constexpr std::size_t kSum = 1;
  static constexpr std::size_t kSmallest = 2;
  static constexpr std::size_t kGreatest = 3;
  static constexpr std::size_t kFirstTime = 4;
  static constexpr std::size_t kLastTime = 5;
  static constexpr std::size_t kFixed = 6;
  static constexpr std::size_t kPerPeriod = 4;

  FremenSettings settings_;
};

}  // namespace perennial
