#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <locale>
#include <set>
#include <string>
#include <vector>

#include "perennial/core/error.h"
#include "perennial/core/feature_extractor.h"

namespace perennial {
namespace {

ExtractionSettings load(const Parameters& parameters) {
  ParameterReader reader(parameters, "/node/extraction/");
  const ExtractionSettings settings = ExtractionSettings::load(reader);
  reader.requireAllUsed();
  return settings;
}

TEST(ExtractionSettings, loadsEveryMember) {
  const ExtractionSettings settings = load({{"features", 123},
                                            {"octaves", 2},
                                            {"layers", 5},
                                            {"min_response", 0.25},
                                            {"descriptor", "intensity"}});
  EXPECT_EQ(settings.features, 123);
  EXPECT_EQ(settings.octaves, 2);
  EXPECT_EQ(settings.layers, 5);
  EXPECT_EQ(settings.min_response, 0.25);
  EXPECT_EQ(settings.descriptor, DescriptorKind::kIntensity);
}

TEST(ExtractionSettings, defaultsAreTheStructsOwn) {
  EXPECT_EQ(load({}).describe(), ExtractionSettings().describe());
}

TEST(ExtractionSettings, refusesWhatIsOutOfRange) {
  const std::vector<Parameters> wrong = {{{"features", 0}},         {{"features", 10001}},   {{"octaves", 0}},
                                         {{"octaves", 7}},          {{"layers", 0}},         {{"layers", 7}},
                                         {{"min_response", -0.1}},  {{"min_response", 1.1}}, {{"feature", 5}},
                                         {{"descriptor", "colour"}}};
  for (const Parameters& parameters : wrong) {
    EXPECT_THROW(load(parameters), ParameterError) << parameters.begin()->first;
  }
}

TEST(ExtractionSettings, theExtractorRefusesTheSame) {
  ExtractionSettings settings;
  settings.octaves = 0;
  EXPECT_THROW(FeatureExtractor{settings}, ParameterError);
  settings = {};
  settings.min_response = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(FeatureExtractor{settings}, ParameterError);
}

TEST(ExtractionSettings, descriptionIsReadable) {
  EXPECT_EQ(ExtractionSettings::published().describe(),
            "surf-brief/1 features=500 octaves=4 layers=3 min_response=3e-06 descriptor=intensity");
  EXPECT_EQ(ExtractionSettings().describe(),
            "surf-brief/1 features=500 octaves=4 layers=3 min_response=3e-06 half_resolution=1 buckets=16x8 "
            "descriptor=orientation");
}

TEST(ExtractionSettings, differentSettingsAreDescribedDifferently) {
  std::set<std::string> texts;
  std::vector<ExtractionSettings> all(8);
  all[1].features = 501;
  all[2].octaves = 3;
  all[3].layers = 4;
  all[4].min_response = 0.0;
  all[5].min_response = 3.1e-6;
  all[6].min_response = std::nextafter(3e-6, 1.0);
  all[7].descriptor = DescriptorKind::kIntensity;
  for (const ExtractionSettings& settings : all) {
    texts.insert(settings.describe());
  }
  EXPECT_EQ(texts.size(), all.size());
}

/// A locale that writes "500" as "5.00" and a comma for the decimal point.
class GroupingLocale : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\2"; }
};

TEST(ExtractionSettings, descriptionDoesNotDependOnTheLocale) {
  ExtractionSettings settings;
  settings.min_response = 0.125;
  const std::string expected = settings.describe();
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new GroupingLocale));
  const std::string text = settings.describe();
  std::locale::global(before);
  EXPECT_EQ(text, expected);
}

}  // namespace
}  // namespace perennial
