#include "perennial/core/fremen_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <random>

#include "perennial/core/error.h"

namespace perennial {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDay = 86400.0;

struct Sample {
  double time_s;
  double value;
};

std::vector<double> learned(const FremenModel& model, const std::vector<Sample>& samples) {
  std::vector<double> state(model.stateSize(), 0.0);
  for (const Sample& sample : samples) {
    model.add(state.data(), sample.time_s, model.phases(sample.time_s), sample.value);
  }
  return state;
}

double predicted(const FremenModel& model, const std::vector<double>& state, double time_s) {
  return model.predict(state.data(), model.phases(time_s));
}

/// Times from `from` to `to`, unevenly spaced, not in order.
std::vector<double> irregularTimes(std::size_t n, double from, double to, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> time(from, to);
  std::vector<double> times(n);
  std::generate(times.begin(), times.end(), [&] { return time(random); });
  return times;
}

/// The definition, by a sum over all samples: gamma_k = 1/n sum (s - mean) exp(j w_k t).
std::complex<double> discreteSum(const std::vector<Sample>& samples, double period_s) {
  double mean = 0.0;
  for (const Sample& sample : samples) {
    mean += sample.value / static_cast<double>(samples.size());
  }
  std::complex<double> sum;
  for (const Sample& sample : samples) {
    sum += (sample.value - mean) * std::polar(1.0, 2.0 * kPi * sample.time_s / period_s);
  }
  return sum / static_cast<double>(samples.size());
}

TEST(FremenModel, spectrumIsThatOfTheDiscreteSum) {
  const FremenModel model;
  std::mt19937 random(1);
  std::vector<Sample> samples;
  for (const double time_s : irregularTimes(300, 0.0, 500.0 * kDay, 2)) {
    samples.push_back({time_s, static_cast<double>(random() % 3) - 1.0});
  }
  const std::vector<double> state = learned(model, samples);
  for (std::size_t k = 0; k < model.settings().periods_s.size(); ++k) {
    const std::complex<double> expected = discreteSum(samples, model.settings().periods_s[k]);
    EXPECT_NEAR(std::abs(model.spectrum(state.data(), k) - expected), 0.0, 1e-9) << "period " << k;
  }
}

TEST(FremenModel, predictsWhatTheDefinitionPredicts) {
  // All candidates ranked by the sum over all samples, the strongest three added up.
  FremenSettings settings;
  settings.order = 3;
  const FremenModel model(settings);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> noise(-0.3, 0.3);
  std::vector<Sample> samples;
  for (const double time_s : irregularTimes(200, 0.0, 30.0 * kDay, 4)) {
    samples.push_back({time_s, std::cos(2.0 * kPi * time_s / kDay) +
                                   0.5 * std::cos(4.0 * kPi * time_s / kDay + 1.0) + noise(random)});
  }
  double mean = 0.0;
  double least = samples[0].value;
  double greatest = samples[0].value;
  for (const Sample& sample : samples) {
    mean += sample.value / 200.0;
    least = std::min(least, sample.value);
    greatest = std::max(greatest, sample.value);
  }
  std::vector<std::pair<double, double>> components;  // strength, period
  for (const double period_s : settings.periods_s) {
    if (1.5 * period_s <= 29.0 * kDay) {
      components.emplace_back(-std::abs(discreteSum(samples, period_s)), period_s);
    }
  }
  ASSERT_EQ(components.size(), 9U) << "all but the year";
  std::sort(components.begin(), components.end());
  const std::vector<double> state = learned(model, samples);
  for (double time_s = 30.0 * kDay; time_s < 32.0 * kDay; time_s += 4321.0) {
    double expected = mean;
    for (std::size_t place = 0; place < 3; ++place) {
      const std::complex<double> gamma = discreteSum(samples, components[place].second);
      expected +=
          2.0 * std::abs(gamma) * std::cos(2.0 * kPi * time_s / components[place].second - std::arg(gamma));
    }
    EXPECT_NEAR(predicted(model, state, time_s), std::clamp(expected, least, greatest), 1e-9);
  }
}

TEST(FremenModel, foretellsDayAndNight) {
  FremenSettings settings;
  settings.order = 1;
  const FremenModel model(settings);
  const auto visible = [](double time_s) { return std::fmod(time_s, kDay) < kDay / 2.0 ? 1.0 : 0.0; };
  std::vector<Sample> samples;
  for (const double time_s : irregularTimes(200, 0.0, 20.0 * kDay, 5)) {
    samples.push_back({time_s, visible(time_s)});
  }
  const std::vector<double> state = learned(model, samples);
  EXPECT_GT(predicted(model, state, 25.25 * kDay), 0.9) << "the middle of the bright half";
  EXPECT_LT(predicted(model, state, 25.75 * kDay), 0.1);
}

TEST(FremenModel, withoutSamplesPredictsZeroAndWithOneTheSample) {
  const FremenModel model;
  EXPECT_EQ(predicted(model, learned(model, {}), 5.0), 0.0);
  EXPECT_EQ(predicted(model, learned(model, {{100.0, -1.0}}), 5.0), -1.0);
  FremenSettings eager;
  eager.min_samples = 1;
  eager.min_cycles = 0.0;
  EXPECT_EQ(predicted(FremenModel(eager), learned(FremenModel(eager), {{100.0, -1.0}}), 5.0), -1.0);
}

TEST(FremenModel, constantSamplesStayConstant) {
  const FremenModel model;
  std::vector<Sample> samples;
  for (const double time_s : irregularTimes(100, 0.0, 800.0 * kDay, 6)) {
    samples.push_back({time_s, 0.3});
  }
  const std::vector<double> state = learned(model, samples);
  for (double time_s = 0.0; time_s < 1000.0 * kDay; time_s += 7.3 * kDay) {
    EXPECT_NEAR(predicted(model, state, time_s), 0.3, 1e-12);
  }
}

TEST(FremenModel, fewSamplesPredictTheMean) {
  FremenSettings settings;
  settings.min_samples = 10;
  const FremenModel model(settings);
  std::vector<Sample> samples;
  for (int i = 0; i < 9; ++i) {
    samples.push_back({i * 0.7 * kDay, i % 2 == 0 ? 1.0 : 0.0});
  }
  const double mean = 5.0 / 9.0;
  EXPECT_NEAR(predicted(model, learned(model, samples), 3.1 * kDay), mean, 1e-12);
  samples.push_back({9 * 0.7 * kDay, 0.0});
  EXPECT_GT(std::abs(predicted(model, learned(model, samples), 3.1 * kDay) - 0.5), 1e-3);
}

TEST(FremenModel, aPeriodCountsOnceItFitsOneAndAHalfTimes) {
  FremenSettings settings;
  settings.periods_s = {kDay};
  settings.min_samples = 2;
  const FremenModel model(settings);
  const auto samplesUntil = [&](double end_s) {
    std::vector<Sample> samples;
    for (double time_s = 0.0; time_s <= end_s; time_s += end_s / 16.0) {
      samples.push_back({time_s, std::cos(2.0 * kPi * time_s / kDay)});
    }
    return learned(model, samples);
  };
  const std::vector<double> before = samplesUntil(1.49 * kDay);
  EXPECT_EQ(predicted(model, before, 2.0 * kDay), FremenModel::mean(before.data()));
  const std::vector<double> after = samplesUntil(1.51 * kDay);
  EXPECT_GT(predicted(model, after, 2.0 * kDay), FremenModel::mean(after.data()) + 0.5);
}

TEST(FremenModel, staysWithinTheRangeOfTheSamples) {
  FremenSettings settings;
  settings.order = 8;
  settings.min_samples = 2;
  const FremenModel model(settings);
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::vector<Sample> samples;
    for (const double time_s : irregularTimes(12, 0.0, 900.0 * kDay, seed)) {
      samples.push_back({time_s, std::fmod(time_s, 3.0) - 1.0});
    }
    const auto [least, greatest] = std::minmax_element(
        samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.value < b.value; });
    const std::vector<double> state = learned(model, samples);
    for (double time_s = -50.0 * kDay; time_s < 1000.0 * kDay; time_s += 9.1 * kDay) {
      const double value = predicted(model, state, time_s);
      EXPECT_GE(value, least->value);
      EXPECT_LE(value, greatest->value);
    }
  }
}

TEST(FremenModel, anOriginFarAwayMakesNoDifference) {
  // Seconds since 1970, where single precision would resolve 128 s.
  FremenSettings settings;
  settings.periods_s = {kDay / 8.0, kDay};
  const FremenModel model(settings);
  std::vector<Sample> near;
  std::vector<Sample> far;
  const double origin_s = 18500.0 * kDay;
  for (const double time_s : irregularTimes(100, 0.0, 10.0 * kDay, 7)) {
    near.push_back({time_s, std::cos(16.0 * kPi * time_s / kDay)});
    far.push_back({origin_s + time_s, near.back().value});
  }
  for (double time_s = 10.0 * kDay; time_s < 11.0 * kDay; time_s += 1000.0) {
    EXPECT_NEAR(predicted(model, learned(model, near), time_s),
                predicted(model, learned(model, far), origin_s + time_s), 1e-6);
  }
}

TEST(FremenModel, predictsFiftyThousandFeaturesInTime) {
  const FremenModel model;
  std::vector<Sample> samples;
  for (const double time_s : irregularTimes(60, 0.0, 900.0 * kDay, 8)) {
    samples.push_back({time_s, std::cos(2.0 * kPi * time_s / kDay)});
  }
  const std::vector<double> one = learned(model, samples);
  std::vector<double> states;
  for (int i = 0; i < 50000; ++i) {
    states.insert(states.end(), one.begin(), one.end());
  }
  const FremenModel::Phases now = model.phases(1000.0 * kDay);
  double best_ms = 1e9;
  double sum = 0.0;
  for (int repetition = 0; repetition < 5; ++repetition) {
    const std::clock_t start = std::clock();  // of this process: the machine may be busy with something else
    for (std::size_t i = 0; i < 50000; ++i) {
      sum += model.predict(states.data() + i * one.size(), now);
    }
    best_ms = std::min(best_ms, 1000.0 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  EXPECT_NE(sum, 0.0);
  RecordProperty("milliseconds", std::to_string(best_ms));
  EXPECT_LT(best_ms, 50.0);
}

TEST(FremenModel, settingsAreChecked) {
  ParameterReader good({{"periods_s", std::vector<double>{kDay}}, {"order", 1}, {"min_samples", 5}});
  const FremenSettings settings = FremenSettings::load(good);
  EXPECT_EQ(settings.periods_s.size(), 1U);
  EXPECT_EQ(settings.min_samples, 5);
  ParameterReader zero_period({{"periods_s", std::vector<double>{0.0}}});
  EXPECT_THROW(FremenSettings::load(zero_period), ParameterError);
  ParameterReader negative_order({{"order", -1}});
  EXPECT_THROW(FremenSettings::load(negative_order), ParameterError);
}

}  // namespace
}  // namespace perennial
