#include "perennial/park/dataset_generator.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "perennial/core/dataset.h"
#include "perennial/core/error.h"
#include "perennial/core/feature_extractor.h"
#include "perennial/core/registration.h"
#include "perennial/testing/temporary_folder.h"

namespace perennial::park {
namespace {

GeneratedDatasetSettings small() {
  GeneratedDatasetSettings settings;
  settings.places = 4;
  settings.traversals = 24;
  settings.days = 20.0;
  settings.camera.geometry.width = 376;
  settings.camera.geometry.height = 240;
  settings.camera.geometry.fx = settings.camera.geometry.fy = 289.5;
  settings.camera.geometry.cx = 187.5;
  settings.camera.geometry.cy = 119.5;
  settings.max_offset_px = 60;
  return settings;
}

TEST(PlanTraversals, isIrregularInTimeAndWeatherAndTheSameAgain) {
  GeneratedDatasetSettings settings;
  const auto plan = planTraversals(settings);
  ASSERT_EQ(plan.size(), 178U);
  EXPECT_EQ(plan[0].conditions.date_time_s, settings.start_s);
  std::set<Weather> weathers;
  int by_night = 0;
  for (std::size_t t = 1; t < plan.size(); ++t) {
    EXPECT_GE(plan[t].conditions.date_time_s, plan[t - 1].conditions.date_time_s);
    EXPECT_LE(plan[t].conditions.date_time_s, settings.start_s + 90.0 * 86400.0 + 1.0);
    EXPECT_GT(plan[t].name, plan[t - 1].name);
    weathers.insert(plan[t].conditions.weather);
    const double hour = std::fmod(plan[t].conditions.date_time_s, 86400.0) / 3600.0;
    by_night += hour < 4.0 || hour > 20.0 ? 1 : 0;
  }
  EXPECT_GE(weathers.size(), 3U);
  EXPECT_GT(by_night, 30);
  EXPECT_EQ(planTraversals(settings)[100].conditions.date_time_s, plan[100].conditions.date_time_s);
  settings.seed = 2;
  EXPECT_NE(planTraversals(settings)[100].conditions.date_time_s, plan[100].conditions.date_time_s);
}

TEST(GenerateDataset, isExactResumesAndRefusesOtherSettings) {
  const test_tools::TemporaryFolder folder;
  const GeneratedDatasetSettings settings = small();
  std::vector<std::size_t> progress;
  generateDataset(folder.path(), settings, [&](std::size_t done) { progress.push_back(done); });
  EXPECT_EQ(progress.size(), 24U);
  const Dataset dataset = loadDataset(folder.path());
  ASSERT_EQ(dataset.rows.size(), 96U);
  ASSERT_EQ(dataset.places().size(), 4U);

  int answered = 0;
  FeatureExtractor extractor;
  for (const auto& place : dataset.places()) {
    const FeatureSet map = extractor.extract(dataset.readImage(place.second[0]));
    for (std::size_t v = 1; v < place.second.size(); ++v) {
      const cv::Mat image = dataset.readImage(place.second[v]);
      ASSERT_EQ(image.size(), cv::Size(376, 240));
      const auto found = makeRegistration({})->registerView(map, extractor.extract(image));
      if (found.inliers >= 20) {
        EXPECT_NEAR(*found.displacement_px, groundTruthDisplacement(place.second[0], place.second[v]), 5.0);
        ++answered;
      }
    }
  }
  EXPECT_GT(answered, 10);

  // As if it had been killed: one traversal lacks an image, and is made again to the byte.
  const std::string lost = folder / "007/002.png";
  const auto content = [&] {
    std::ifstream stream(lost, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  const std::string before = content();
  const auto untouched = std::filesystem::last_write_time(folder / "008/002.png");
  std::filesystem::remove(lost);
  generateDataset(folder.path(), settings, [](std::size_t) {});
  EXPECT_EQ(content(), before);
  EXPECT_EQ(std::filesystem::last_write_time(folder / "008/002.png"), untouched);

  GeneratedDatasetSettings other = settings;
  other.seed = 2;
  EXPECT_THROW(generateDataset(folder.path(), other, [](std::size_t) {}), Error);
}

}  // namespace
}  // namespace perennial::park
