#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "perennial/park/camera_model.h"
#include "perennial/park/conditions.h"
#include "perennial/park/loop_path.h"

namespace perennial::park {

/// A long-term data set of the park: the same places of a path, seen again and again through a season.
struct GeneratedDatasetSettings {
  int places = 32;       ///< evenly along the path
  int traversals = 178;  ///< the first one, by day, is the teaching
  double days = 90.0;    ///< that they spread over, at irregular times of day and night
  int seed = 1;          ///< of times, weather, offsets and noise
  double start_s =
      1788253200.0;  ///< first traversal, seconds since 1970; 2026-09-01T09:00:00Z: leaves are about to turn
  int max_offset_px = 120;        ///< images are cut from wider ones, up to this far to either side
  double position_error_m = 0.0;  ///< standard deviation of where the robot stands, along and across the path
  LoopSettings loop;
  CameraSettings camera;
};

/// When a traversal takes place, and in what weather.
struct PlannedTraversal {
  std::string name;  ///< "000", "001", ...
  Conditions conditions;
};

/// The traversals of a data set, in order of time. The same settings give the same plan.
std::vector<PlannedTraversal> planTraversals(const GeneratedDatasetSettings& settings);

/// Writes the data set to a folder: PNG images and manifest.csv. Each image is cut from a wider rendered one
/// at a known horizontal position, so that the displacement between any two images of a place is exact to the
/// pixel (where `position_error_m` is 0). The manifest always lists the traversals that are complete; those
/// are not made again, so a run that was killed goes on where it stopped. `progress` gets the number of
/// complete traversals. Throws Error when the folder cannot be written, and when it holds a data set of other
/// settings.
void generateDataset(const std::string& folder, const GeneratedDatasetSettings& settings,
                     const std::function<void(std::size_t)>& progress);

}  // namespace perennial::park
