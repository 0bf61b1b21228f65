// core_displacements DATASET TAUGHT REPEATED [GROUP/KEY=VALUE]...: registers one traversal of a data set
// against another in one process, on the core alone, and prints a line for each image: distance, displacement
// or "none", ground truth. The numbers are hexadecimal, so that a test can compare them with the nodes' to
// the last digit.
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "perennial/core/dataset.h"
#include "perennial/core/feature_extractor.h"
#include "perennial/core/registration.h"
#include "perennial/evaluation/run_settings.h"

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: core_displacements DATASET TAUGHT REPEATED [GROUP/KEY=VALUE]...\n");
    return 2;
  }
  try {
    const perennial::Dataset dataset = perennial::loadDataset(argv[1]);
    const std::vector<perennial::DatasetRow> taught = dataset.traversal(argv[2]);
    const std::vector<perennial::DatasetRow> repeated = dataset.traversal(argv[3]);
    perennial::RunSettings settings("none");
    for (int i = 4; i < argc; ++i) {
      settings.set(argv[i]);
    }
    perennial::FeatureExtractor extractor(settings.extraction());
    const auto registration = perennial::makeRegistration(settings.registration());
    for (std::size_t i = 0; i < taught.size() && i < repeated.size(); ++i) {
      const perennial::FeatureSet map = extractor.extract(dataset.readImage(taught[i]));
      const perennial::FeatureSet view = extractor.extract(dataset.readImage(repeated[i]));
      const perennial::RegistrationResult result = registration->registerView(map, view);
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
