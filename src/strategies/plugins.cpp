// Declares this package's strategies as plugins; their names for map_manager stand in strategies.xml.
#include <pluginlib/class_list_macros.hpp>

#include "perennial/strategies/aggressive_map.h"
#include "perennial/strategies/anchored_map.h"
#include "perennial/strategies/fremen_map.h"
#include "perennial/strategies/latest_map.h"
#include "perennial/strategies/multiple_maps.h"
#include "perennial/strategies/score_based.h"
#include "perennial/strategies/static_map.h"
#include "perennial/strategies/strict_map.h"
#include "perennial/strategies/summary_map.h"

PLUGINLIB_EXPORT_CLASS(perennial::strategies::StaticMap, perennial::MapStrategy)
PLUGINLIB_EXPORT_CLASS(perennial::strategies::LatestMap, perennial::MapStrategy)
PLUGINLIB_EXPORT_CLASS(perennial::strategies::AggressiveMap, perennial::MapStrategy)
PLUGINLIB_EXPORT_CLASS(perennial::strategies::StrictMap, perennial::MapStrategy)
PLUGINLIB_EXPORT_CLASS(perennial::strategies::SummaryMap, perennial::MapStrategy)
PLUGINLIB_EXPORT_CLASS(perennial::strategies::MultipleMaps, perennial::MapStrategy)
PLUGINLIB_EXPORT_CLASS(perennial::strategies::ScoreBased, perennial::MapStrategy)
PLUGINLIB_EXPORT_CLASS(perennial::strategies::FremenMap, perennial::MapStrategy)
PLUGINLIB_EXPORT_CLASS(perennial::strategies::AnchoredMap, perennial::MapStrategy)
