// core_displacements DATASET TAUGHT REPEATED [RATIO MIN_INLIERS]: registers one traversal of a data set against another in one process, on the
// core alone, and prints a line for each image: distance, displacement or "none", ground truth. The numbers are hexadecimal, so
// that a test can compare them with the nodes' to the last digit.
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "perennial/core/dataset.h"
#include "perennial/core/feature_extractor.h"
#include "perennial/core/registration.h"

int main(int argc, char** argv) {
  if (argc != 4 && argc != 6) {
    std::fprintf(stderr, "usage: core_displacements DATASET TAUGHT REPEATED [RATIO MIN_INLIERS]\n");
    return 2;
  }
  try {
    const perennial::Dataset dataset = perennial::loadDataset(argv[1]);
    const std::vector<perennial::DatasetRow> taught = dataset.traversal(argv[2]);
    const std::vector<perennial::DatasetRow> repeated = dataset.traversal(argv[3]);
    perennial::FeatureExtractor extractor;
    perennial::RegistrationSettings settings;
    if (argc == 6) {
      settings.ratio = std::stod(argv[4]);
      settings.min_inliers = std::stoi(argv[5]);
    }
    const perennial::HistogramRegistration registration(settings);
    for (std::size_t i = 0; i < taught.size() && i < repeated.size(); ++i) {
      const perennial::FeatureSet map = extractor.extract(dataset.readImage(taught[i]));
      const perennial::FeatureSet view = extractor.extract(dataset.readImage(repeated[i]));
      const perennial::RegistrationResult result = registration.registerView(map, view);
      std::printf("%a ", repeated[i].distance_m);
      if (result.displacement_px) {
        std::printf("%a", *result.displacement_px);
      } else {
        std::printf("none");
      }
      std::printf(" %a\n", perennial::groundTruthDisplacement(taught[i], repeated[i]));
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "core_displacements: %s\n", error.what());
    return 1;
  }
}
