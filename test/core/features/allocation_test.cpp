#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "core/features/synthetic_images.h"
#include "perennial/core/feature_extractor.h"
#include "perennial/core/registration.h"

/// A program of its own, because it counts every allocation.
namespace {

int allocations = 0;

}  // namespace

void* operator new(std::size_t size) {
  ++allocations;
  void* const memory = std::malloc(size);
  if (memory == nullptr) {
    throw std::bad_alloc();
  }
  return memory;
}

void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }

namespace perennial {
namespace {

/// A robot runs for hours: after the first image only the result, two arrays, is allocated.
TEST(FeatureExtractor, keepsItsMemory) {
  const cv::Mat image = texture(400, 300, 81);
  const cv::Mat darker = 0.8 * image;
  FeatureExtractor extractor;
  extractor.extract(image);
  const int before = allocations;
  const FeatureSet features = extractor.extract(darker);
  EXPECT_EQ(features.size(), 500U);
  EXPECT_EQ(allocations - before, 2);
}

/// The whole frame into memory that is there already: nothing at all is allocated.
TEST(WholeFrame, allocatesNothing) {
  ExtractionSettings bucketed;
  bucketed.half_resolution = true;
  bucketed.bucket_columns = 16;
  bucketed.bucket_rows = 8;
  const cv::Mat image = texture(640, 480, 82);
  const cv::Mat darker = 0.8 * image;
  for (const ExtractionSettings& extraction : {ExtractionSettings(), bucketed}) {
    for (const auto method : {RegistrationMethod::kHistogram, RegistrationMethod::kRobust}) {
      RegistrationSettings settings;
      settings.method = method;
      const auto registration = makeRegistration(settings);
      FeatureExtractor extractor(extraction);
      const FeatureSet map = extractor.extract(image);
      FeatureSet view;
      RegistrationWorkspace workspace;
      RegistrationResult result;
      const auto frame = [&](const cv::Mat& seen) {
        extractor.extractInto(seen, view);
        registration->registerInto(map, view, workspace, result);
      };
      frame(image);
      frame(darker);
      const int before = allocations;
      frame(image);
      frame(darker);
      EXPECT_EQ(allocations - before, 0);
      EXPECT_TRUE(result.displacement_px);
    }
  }
}

}  // namespace
}  // namespace perennial
