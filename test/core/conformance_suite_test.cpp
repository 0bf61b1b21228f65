// The conformance suite finds what is broken; BROKEN_STRATEGIES is the program that runs it over such
// strategies.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <string>

namespace perennial {
namespace {

struct Result {
  int status = -1;
  std::string output;
};

Result runSuite(const std::string& strategy) {
  Result result;
  const std::string command = std::string(BROKEN_STRATEGIES) + " --gtest_filter='" + strategy + "/*' 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  char buffer[4096];
  for (std::size_t count = 0; pipe != nullptr && (count = fread(buffer, 1, sizeof(buffer), pipe)) > 0;) {
    result.output.append(buffer, count);
  }
  const int status = pclose(pipe);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

struct Broken {
  const char* strategy;
  const char* test;  ///< that must find it
};

class ConformanceSuite : public ::testing::TestWithParam<Broken> {};

TEST_P(ConformanceSuite, finds) {
  const Result result = runSuite(GetParam().strategy);
  EXPECT_EQ(result.status, 1) << "it must fail, and not crash";
  const std::string failure =
      std::string("[  FAILED  ] ") + GetParam().strategy + "/StrategyConformance." + GetParam().test + "/0";
  EXPECT_NE(result.output.find(failure), std::string::npos) << result.output;
}

INSTANTIATE_TEST_SUITE_P(
    Broken, ConformanceSuite,
    ::testing::Values(Broken{"GrowsWithoutEnd", "keepsInvariantsOverAThousandUpdates"},
                      Broken{"UsesWhatIsNotThere", "keepsInvariantsOverAThousandUpdates"},
                      Broken{"UsesInNoOrder", "keepsInvariantsWhateverHappens"},
                      Broken{"OffersNothing", "copesWithTimesOfAnyOrder"},
                      Broken{"RemembersOutsideOfTheMap", "isDeterministicAndKeepsItsStateInTheMap"},
                      Broken{"DrawsUnseededNumbers", "isDeterministicAndKeepsItsStateInTheMap"},
                      Broken{"ForgetsWhatIsNotSeen", "losesNothingOnAnEmptyView"},
                      Broken{"DropsEverything", "keepsInvariantsWhateverHappens"},
                      Broken{"GetsOutOfStep", "copesWithMapsOfAnySize"},
                      Broken{"WritesNaN", "keepsInvariantsOverAThousandUpdates"},
                      Broken{"GivesIdentitiesAgain", "keepsInvariantsOverAThousandUpdates"},
                      Broken{"ChangesDescriptors", "keepsInvariantsOverAThousandUpdates"},
                      Broken{"InventsFeatures", "keepsInvariantsOverAThousandUpdates"},
                      Broken{"MovesThePlace", "copesWithMapsOfAnySize"},
                      Broken{"CannotGoBackInTime", "copesWithTimesOfAnyOrder"},
                      Broken{"HasNoName", "hasANameAndAVersion"},
                      Broken{"SwallowsParameters", "refusesUnknownParameters"}),
    [](const ::testing::TestParamInfo<Broken>& info) { return std::string(info.param.strategy); });

TEST(HealthyStrategy, passesTheConformanceSuite) {
  const Result result = runSuite("Healthy");
  EXPECT_EQ(result.status, 0) << result.output;
  EXPECT_NE(result.output.find("[  PASSED  ]"), std::string::npos) << result.output;
}

}  // namespace
}  // namespace perennial
