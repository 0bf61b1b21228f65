#include "core/simd/kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "core/features/box_hessian.h"
#include "core/features/integral_image.h"
#include "core/features/maxima.h"
#include "core/features/orientation_image.h"
#include "core/features/synthetic_images.h"
#include "core/registration/descriptor_table.h"
#include "core/registration/edge_correlation.h"
#include "core/registration/neighbour_list.h"
#include "perennial/core/feature_extractor.h"
#include "perennial/core/registration.h"

namespace perennial {
namespace {

/// Each path that this processor has, forced.
class EachPath : public ::testing::TestWithParam<std::size_t> {
 protected:
  EachPath() { useKernels(path()); }
  ~EachPath() override { useKernels(*availableKernels().back()); }

  static const Kernels& scalar() { return *availableKernels().front(); }
  static const Kernels& path() { return *availableKernels()[GetParam()]; }
};

std::vector<ExtractionSettings> kindsOfExtraction() {
  ExtractionSettings few = ExtractionSettings::published();
  few.features = 40;
  ExtractionSettings intensity;
  intensity.descriptor = DescriptorKind::kIntensity;
  return {ExtractionSettings::published(), few, intensity, ExtractionSettings()};
}

TEST_P(EachPath, isTheOneInUse) { EXPECT_STREQ(kernels().name, path().name); }

TEST_P(EachPath, findsTheSameFeatures) {
  // Widths that leave every remainder behind the vectors.
  for (const int columns : {97, 128, 203, 347, 640}) {
    const cv::Mat image = texture(columns, 211, static_cast<std::uint64_t>(columns));
    for (const ExtractionSettings& settings : kindsOfExtraction()) {
      FeatureExtractor extractor(settings);
      const FeatureSet first = extractor.extract(image);
      const FeatureSet second =
          extractor.extract(image);  // with a threshold that has adapted: much is left out
      useKernels(scalar());
      const FeatureSet expected = FeatureExtractor(settings).extract(image);
      useKernels(path());
      EXPECT_EQ(first, expected) << path().name << " " << columns;
      EXPECT_EQ(second, expected) << path().name << " " << columns;
    }
  }
}

/// A response that may reach the threshold is computed, to the bit; one that is left out is below it.
TEST_P(EachPath, leavesOutOnlyWhatStaysBelowTheThreshold) {
  const int columns = 211;
  IntegralImage integral;
  integral.compute(texture(columns, 90, 12));
  ColumnDifferences all;
  ColumnDifferences some;
  all.resize(columns + 1);
  some.resize(columns + 1);
  for (const int lobe : {3, 5, 7, 9, 11, 13}) {
    const BoxFilter filter{lobe};
    const int count = columns - 2 * filter.half();
    const FilterRows rows(integral, filter, 45);
    std::vector<float> expected(static_cast<std::size_t>(count));
    differenceColumns(rows, 0, columns + 1, all);
    hessianRow(all, filter, filter.half(), 1, count, expected.data());
    std::vector<float> sorted = expected;
    std::sort(sorted.begin(), sorted.end());
    for (const float threshold :
         {sorted.front(), sorted[sorted.size() / 2], sorted[sorted.size() * 9 / 10], 1.0F}) {
      std::vector<float> found(static_cast<std::size_t>(count) + 1, 7.0F);
      const int computed =
          kernels().filter_row_above(rows, filter, filter.half(), count, threshold, some, found.data());
      EXPECT_EQ(found.back(), 7.0F) << "nothing is written beyond";
      found.pop_back();
      EXPECT_EQ(count - std::count(found.begin(), found.end(), kBelowThreshold), computed);
      for (int i = 0; i < count; ++i) {
        const auto at = static_cast<std::size_t>(i);
        EXPECT_EQ(hessianAt(integral, filter, filter.half() + i, 45), expected[at]);
        EXPECT_TRUE(found[at] == expected[at] || (found[at] == kBelowThreshold && expected[at] < threshold));
      }
    }
  }
}

TEST_P(EachPath, registersTheSame) {
  const cv::Mat wide = texture(700, 300, 9);
  const FeatureSet map = FeatureExtractor().extract(wide(cv::Rect(0, 0, 640, 300)).clone());
  const FeatureSet view = FeatureExtractor().extract(wide(cv::Rect(33, 2, 640, 298)).clone());
  for (const auto method : {RegistrationMethod::kHistogram, RegistrationMethod::kRobust}) {
    RegistrationSettings settings;
    settings.method = method;
    const auto registration = makeRegistration(settings);
    const RegistrationResult result = registration->registerView(map, view);
    useKernels(scalar());
    const RegistrationResult expected = registration->registerView(map, view);
    useKernels(path());
    ASSERT_TRUE(expected.displacement_px);
    EXPECT_EQ(result.displacement_px, expected.displacement_px);
    EXPECT_EQ(result.partners, expected.partners);
    EXPECT_EQ(result.states, expected.states);
    EXPECT_EQ(result.confidence, expected.confidence);
  }
}

TEST_P(EachPath, edgesAreTheSame) {
  const cv::Mat image = texture(523, 301, 10);
  const EdgeField found = FeatureExtractor().extract(image).edges;
  useKernels(scalar());
  EXPECT_EQ(found, FeatureExtractor().extract(image).edges);
  EXPECT_FALSE(found.empty());
}

TEST_P(EachPath, productSumsAreTheSame) {
  std::mt19937 random(6);
  std::vector<std::int16_t> a(20 * 300 + 40);
  std::vector<std::int16_t> b(a.size());
  const auto fill = [&](int amplitude) {
    for (auto* values : {&a, &b}) {
      for (auto& value : *values) {
        value = static_cast<std::int16_t>(
            static_cast<int>(random() % (2U * static_cast<unsigned>(amplitude) + 1U)) - amplitude);
      }
    }
  };
  for (const int amplitude : {1, 127}) {
    fill(amplitude);
    for (const std::size_t count : {kProductBlock, 3 * kProductBlock, 8 * kProductBlock}) {
      for (const std::size_t rows : {0U, 1U, 19U}) {
        for (const std::size_t offset : {0U, 1U, 38U}) {  // shifts need no alignment
          EXPECT_EQ(kernels().product_sum(a.data() + offset, b.data(), 300, rows, count),
                    productSum(a.data() + offset, b.data(), 300, rows, count));
        }
      }
    }
  }
  // The largest fields there are, with the largest values.
  const std::size_t cells = EdgeField::kMostCells;
  const std::vector<std::int16_t> extreme(2 * cells * cells, -127);
  EXPECT_EQ(kernels().product_sum(extreme.data(), extreme.data(), 2 * cells, cells, 2 * cells),
            static_cast<std::int32_t>(2 * cells * cells * 127 * 127));
}

TEST_P(EachPath, distancesAreThoseOfTwoDescriptors) {
  std::mt19937_64 random(3);
  const auto descriptor = [&] {
    Descriptor result;
    std::generate(result.words.begin(), result.words.end(), [&] { return random(); });
    return result;
  };
  const Descriptor one = descriptor();
  std::vector<Descriptor> others{one, one};
  for (auto& word : others[1].words) {
    word = ~word;  // 256 bits away
  }
  while (others.size() < 37) {
    others.push_back(descriptor());
  }
  DescriptorTable table;
  table.resize(others.size());
  for (std::size_t i = 0; i < others.size(); ++i) {
    table.set(i, others[i]);
  }
  for (std::size_t begin = 0; begin <= others.size(); begin += 5) {
    std::vector<std::uint16_t> distances(others.size() - begin + 1, 9999);
    kernels().hamming_distances(one, table, begin, others.size(), distances.data());
    for (std::size_t j = begin; j < others.size(); ++j) {
      EXPECT_EQ(distances[j - begin], hammingDistance(one, others[j]));
    }
    EXPECT_EQ(distances.back(), 9999) << "nothing is written beyond";
  }
}

/// Lists of nearest neighbours, as offering one by one makes them.
class Neighbours {
 public:
  Neighbours(std::size_t rows, std::size_t columns)
      : of_map(rows), of_view(columns), bounds(columns + kOfferBeyond, NeighbourList::kNoBound) {}

  bool operator==(const Neighbours& other) const {
    return same(of_map, other.of_map) && same(of_view, other.of_view);
  }

  std::vector<NeighbourList> of_map;
  std::vector<NeighbourList> of_view;
  std::vector<std::uint16_t> bounds;

 private:
  static bool same(const std::vector<NeighbourList>& a, const std::vector<NeighbourList>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), [](const NeighbourList& p, const NeighbourList& q) {
      bool equal = p.size() == q.size();
      for (std::size_t rank = 0; equal && rank < p.size(); ++rank) {
        equal = p[rank].distance == q[rank].distance && p[rank].index == q[rank].index;
      }
      return equal;
    });
  }
};

TEST_P(EachPath, theNearestAreThoseOfferedOneByOne) {
  std::mt19937 random(8);
  for (const std::size_t columns : {1U, 4U, 6U, 33U, 150U}) {
    std::vector<std::uint32_t> indices(columns);
    std::iota(indices.begin(), indices.end(), 0U);
    std::shuffle(indices.begin(), indices.end(), random);
    for (const unsigned range : {2U, 30U, 257U}) {  // many equal ones, or few
      const std::size_t rows = 40;
      Neighbours found(rows, columns);
      Neighbours expected(rows, columns);
      for (std::size_t row = 0; row < rows; ++row) {
        const std::size_t begin = random() % columns;
        const std::size_t count = random() % (columns - begin + 1);
        std::vector<std::uint16_t> distances(count + kOfferBeyond, NeighbourList::kNoBound);
        std::generate_n(distances.begin(), count,
                        [&] { return static_cast<std::uint16_t>(random() % range); });
        const auto index = static_cast<std::uint32_t>(row);
        kernels().offer_row({distances.data(), count, index, indices.data() + begin}, found.of_map[row],
                            found.of_view.data(), found.bounds.data() + begin);
        for (std::size_t i = 0; i < count; ++i) {
          expected.of_map[row].offer(distances[i], indices[begin + i]);
          expected.of_view[indices[begin + i]].offer(distances[i], index);
        }
      }
      EXPECT_TRUE(found == expected) << columns << " " << range;
      for (std::size_t i = 0; i < columns; ++i) {
        EXPECT_EQ(found.bounds[i], expected.of_view[indices[i]].bound());
      }
    }
  }
}

TEST_P(EachPath, theTwoSmallestAreThoseOfASort) {
  std::mt19937 random(6);
  for (std::size_t count = 0; count <= 70; ++count) {
    for (const unsigned range : {3U, 257U}) {  // with many equal ones, and with few
      std::vector<std::uint16_t> distances(count);
      std::generate(distances.begin(), distances.end(),
                    [&] { return static_cast<std::uint16_t>(random() % range); });
      const SmallestTwo found = kernels().smallest_two(distances.data(), count);
      std::sort(distances.begin(), distances.end());
      distances.resize(std::max<std::size_t>(count, 2), SmallestTwo::kNone);
      EXPECT_EQ(found.first, distances[0]) << count;
      EXPECT_EQ(found.second, distances[1]) << count;
    }
  }
}

TEST_P(EachPath, sumsOfPixelsAreTheSame) {
  std::mt19937 random(7);
  for (const int columns : {0, 1, 3, 4, 31, 64, 203}) {
    const auto size = static_cast<std::size_t>(columns) + 1;
    std::vector<std::uint8_t> pixels(size);
    std::vector<std::uint32_t> above(size);
    std::generate(pixels.begin(), pixels.end(), [&] { return static_cast<std::uint8_t>(random()); });
    std::generate(above.begin(), above.end(), [&] { return static_cast<std::uint32_t>(random()); });
    std::vector<std::uint32_t> found(size + 1, 7);
    std::vector<std::uint32_t> expected = found;
    kernels().integral_row(pixels.data(), above.data(), columns, found.data());
    integralRow(pixels.data(), above.data(), columns, expected.data());
    EXPECT_EQ(found, expected) << columns;
    EXPECT_EQ(found.back(), 7U) << "nothing is written beyond";
  }
}

TEST_P(EachPath, takesEveryOther) {
  for (const int count : {0, 1, 4, 17, 32, 67}) {
    std::vector<float> values(2 * static_cast<std::size_t>(count) + 1);
    std::iota(values.begin(), values.end(), 1.0F);
    std::vector<float> apart(static_cast<std::size_t>(count) + 1, -1.0F);
    kernels().every_other(values.data(), count, apart.data());
    EXPECT_EQ(apart.back(), -1.0F) << "nothing is written beyond";
    kernels().every_other(values.data(), count, values.data());
    for (std::size_t i = 0; i + 1 < apart.size(); ++i) {
      EXPECT_EQ(apart[i], static_cast<float>(2 * i + 1));
      EXPECT_EQ(values[i], apart[i]) << "in place";
    }
  }
}

TEST_P(EachPath, orientationsAreTheSame) {
  // Smooth, as it is, rough, and the steepest there can be.
  std::mt19937 random(5);
  std::vector<std::uint16_t> rows[3];
  for (auto& row : rows) {
    for (int i = 0; i < 205; ++i) {
      const int kind = i / 70;
      const auto value = kind == 0   ? 2000 + random() % 40
                         : kind == 1 ? random() % 4081
                                     : 4080 * (random() % 2);
      row.push_back(static_cast<std::uint16_t>(value));
    }
  }
  for (const int count : {0, 1, 7, 16, 63, 203}) {
    const auto size = static_cast<std::size_t>(count) + 1;
    std::vector<std::uint8_t> found[2]{std::vector<std::uint8_t>(size, 7),
                                       std::vector<std::uint8_t>(size, 7)};
    auto expected = found[0];
    auto expected_sine = found[1];
    kernels().orientation_row(rows[0].data(), rows[1].data(), rows[2].data(), count, found[0].data(),
                              found[1].data());
    orientationRow(rows[0].data(), rows[1].data(), rows[2].data(), count, expected.data(),
                   expected_sine.data());
    EXPECT_EQ(found[0], expected) << count;
    EXPECT_EQ(found[1], expected_sine) << count;
  }
}

TEST_P(EachPath, peaksAreTheSame) {
  // Few different values, so that there are many equal neighbours.
  std::mt19937 random(4);
  std::vector<float> rows[3];
  for (auto& row : rows) {
    for (int i = 0; i < 203 + kReadBeyond; ++i) {
      row.push_back(static_cast<float>(random() % 5));
    }
  }
  int peaks = 0;
  for (int i = 1; i < 202; ++i) {
    const int found = kernels().next_peak(rows[0].data(), rows[1].data(), rows[2].data(), i, 202, 3.0F);
    EXPECT_EQ(found, nextPeak(rows[0].data(), rows[1].data(), rows[2].data(), i, 202, 3.0F));
    peaks += found == i ? 1 : 0;
  }
  EXPECT_GT(peaks, 5);
}

INSTANTIATE_TEST_SUITE_P(Kernels, EachPath, ::testing::Range<std::size_t>(0, availableKernels().size()),
                         [](const auto& info) { return std::string(availableKernels()[info.param]->name); });

TEST(Kernels, theScalarPathIsAlwaysThereAndTheLastIsInUse) {
  EXPECT_STREQ(availableKernels().front()->name, "scalar");
  EXPECT_EQ(&kernels(), availableKernels().back());
}

#ifdef PERENNIAL_HAS_VECTOR_CODE
TEST(Kernels, everyBuiltPathThatRunsHereIsThere) {
  EXPECT_GT(availableKernels().size(), 1U);
#if defined(__x86_64__)
  const auto has = [](const std::string& name) {
    return std::any_of(availableKernels().begin(), availableKernels().end(),
                       [&](const Kernels* path) { return path->name == name; });
  };
  EXPECT_EQ(has("avx2"), __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"));
  EXPECT_EQ(has("avx512"), __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"));
#endif
}
#endif

}  // namespace
}  // namespace perennial
