#pragma once

#include <opencv2/core.hpp>

namespace perennial::park {

/// Textures painted by rules and seeded numbers: no picture files. All are the same on every call.

/// Ground, CV_8UC4, square, repeats seamlessly. Channels: 0 grass, 1 gravel, 2 fallen leaves (0: none), 3
/// soft noise.
cv::Mat groundTexture(int size_px);

/// Tiles of the atlas that plants and objects are covered with.
enum class Tile { kLeaves, kTwigs, kNeedles, kBark, kBricks, kPlanks, kRoof, kPlain };
constexpr int kAtlasColumns = 4;
constexpr int kAtlasRows = 2;

/// Grey and opacity, CV_8UC4 (grey in the first three channels), kAtlasColumns x kAtlasRows square tiles.
cv::Mat objectAtlas(int tile_px);

}  // namespace perennial::park
