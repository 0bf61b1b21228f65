// The conformance suite over this package's strategies with settings other than the default ones.
#include "perennial/strategies/aggressive_map.h"
#include "perennial/strategies/anchored_map.h"
#include "perennial/strategies/fremen_map.h"
#include "perennial/strategies/multiple_maps.h"
#include "perennial/strategies/score_based.h"
#include "perennial/strategies/strict_map.h"
#include "perennial/strategies/summary_map.h"
#include "perennial/testing/strategy_conformance.h"

namespace perennial::test_tools {
namespace {

using namespace strategies;  // NOLINT: names of the classes under test

INSTANTIATE_TEST_SUITE_P(RandomAdd, StrategyConformance,
                         ::testing::Values(strategyUnderTest<AggressiveMap>({{"random_add", true}}),
                                           strategyUnderTest<StrictMap>({{"random_add", true}}),
                                           strategyUnderTest<SummaryMap>({{"random_add", true},
                                                                          {"max_features", 200}}),
                                           strategyUnderTest<ScoreBased>({{"random_add", true}}),
                                           strategyUnderTest<FremenMap>({{"random_add", true}}),
                                           strategyUnderTest<AnchoredMap>({{"random_add", true}})));

INSTANTIATE_TEST_SUITE_P(
    Limits, StrategyConformance,
    ::testing::Values(
        strategyUnderTest<AnchoredMap>({{"share", 1.0}, {"features_kept", 1}}),
        strategyUnderTest<AnchoredMap>({{"features_kept", 100}, {"taught_share", 0.0}}),

        strategyUnderTest<SummaryMap>({{"share", 1.0}, {"max_features", 1}}),
        strategyUnderTest<SummaryMap>({{"share", 1.0}, {"max_features", 300}}),
        strategyUnderTest<MultipleMaps>({{"max_alternatives", 1}}),
        strategyUnderTest<MultipleMaps>({{"max_alternatives", 2}, {"min_correct", 60}}),
        strategyUnderTest<ScoreBased>({{"exchange", 1.0}}),
        strategyUnderTest<ScoreBased>({{"exchange_count", 1000}}),
        strategyUnderTest<ScoreBased>({{"features_kept", 200}, {"features_used", 50}}),
        strategyUnderTest<FremenMap>({{"features_used", 30}, {"features_kept", 100}, {"exchange", 0.2}}),
        strategyUnderTest<FremenMap>({{"periods_s", std::vector<double>{}}}),
        strategyUnderTest<FremenMap>({{"order", 16}, {"min_samples", 1}, {"min_cycles", 0.0}})));

}  // namespace
}  // namespace perennial::test_tools
