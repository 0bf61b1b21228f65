// Declares this package's strategies as plugins; their names for map_manager stand in strategies.xml.
#include <pluginlib/class_list_macros.hpp>

#include "perennial/strategies/latest_map.h"
#include "perennial/strategies/score_based.h"
#include "perennial/strategies/static_map.h"

PLUGINLIB_EXPORT_CLASS(perennial::strategies::StaticMap, perennial::MapStrategy)
PLUGINLIB_EXPORT_CLASS(perennial::strategies::LatestMap, perennial::MapStrategy)
PLUGINLIB_EXPORT_CLASS(perennial::strategies::ScoreBased, perennial::MapStrategy)
