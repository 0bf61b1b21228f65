// Frequency map enhancement: Krajnik et al., T-RO 2017, in the incremental form for samples at irregular
// times.
#include "perennial/core/fremen_model.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace perennial {
namespace {

constexpr double kTwoPi = 6.283185307179586476925286766559;
constexpr std::size_t kMaxOrder = 16;

}  // namespace

FremenSettings FremenSettings::load(ParameterReader& reader) {
  FremenSettings settings;
  settings.periods_s = reader.reals("periods_s", settings.periods_s, 1.0, 1e9);
  settings.order = reader.integer("order", settings.order, 0, static_cast<int>(kMaxOrder));
  settings.min_samples = reader.integer("min_samples", settings.min_samples, 1, 1000000);
  settings.min_cycles = reader.real("min_cycles", settings.min_cycles, 0.0, 1000.0);
  return settings;
}

FremenModel::FremenModel(const FremenSettings& settings) : settings_(settings) {}

FremenModel::Phases FremenModel::phases(double time_s) const {
  Phases phases;
  phases.reserve(settings_.periods_s.size());
  for (const double period_s : settings_.periods_s) {
    phases.push_back(std::polar(1.0, kTwoPi * std::fmod(time_s, period_s) / period_s));
  }
  return phases;
}

void FremenModel::add(double* state, double time_s, const Phases& phases, double sample) const {
  const bool first = state[kCount] == 0.0;
  state[kCount] += 1.0;
  state[kSum] += sample;
  state[kSmallest] = first ? sample : std::min(state[kSmallest], sample);
  state[kGreatest] = first ? sample : std::max(state[kGreatest], sample);
  state[kFirstTime] = first ? time_s : std::min(state[kFirstTime], time_s);
  state[kLastTime] = first ? time_s : std::max(state[kLastTime], time_s);
  double* sums = state + kFixed;
  for (const std::complex<double>& phase : phases) {
    sums[0] += sample * phase.real();
    sums[1] += sample * phase.imag();
    sums[2] += phase.real();
    sums[3] += phase.imag();
    sums += kPerPeriod;
  }
}

std::complex<double> FremenModel::spectrum(const double* state, std::size_t k) const {
  const double* sums = state + kFixed + kPerPeriod * k;
  const double mu = mean(state);
  return {(sums[0] - mu * sums[2]) / state[kCount], (sums[1] - mu * sums[3]) / state[kCount]};
}

double FremenModel::predict(const double* state, const Phases& phases) const {
  const double mu = mean(state);
  if (state[kCount] < settings_.min_samples || state[kSmallest] == state[kGreatest]) {
    return mu;
  }
  const double observed_s = state[kLastTime] - state[kFirstTime];
  // The strongest candidates so far, by falling strength.
  struct Component {
    double strength = 0.0;
    double value = 0.0;
  };
  std::array<Component, kMaxOrder> strongest;
  const auto order = std::min(static_cast<std::size_t>(settings_.order), kMaxOrder);
  for (std::size_t k = 0; k < phases.size(); ++k) {
    if (settings_.min_cycles * settings_.periods_s[k] > observed_s) {
      continue;
    }
    const std::complex<double> gamma = spectrum(state, k);
    // |gamma| cos(w t - arg gamma) is the scalar product of gamma and exp(j w t).
    Component component{std::norm(gamma),
                        2.0 * (gamma.real() * phases[k].real() + gamma.imag() * phases[k].imag())};
    for (std::size_t place = 0; place < order; ++place) {
      if (component.strength > strongest[place].strength) {
        std::swap(component, strongest[place]);
      }
    }
  }
  double prediction = mu;
  for (std::size_t place = 0; place < order; ++place) {
    prediction += strongest[place].value;
  }
  return std::clamp(prediction, state[kSmallest], state[kGreatest]);
}

}  // namespace perennial
