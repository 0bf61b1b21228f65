#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "core/features/synthetic_images.h"
#include "perennial/core/feature_extractor.h"
#include "perennial/core/registration.h"
#include "perennial/core/repeat_session.h"

/// A program of its own, because it counts every allocation: those of C++, and those of OpenCV's matrices,
/// which take their memory from the C library.
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

/// Of OpenCV's matrices.
class CountingAllocator : public cv::MatAllocator {
 public:
  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, std::size_t* step,
                         cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    ++allocations;
    return cv::Mat::getStdAllocator()->allocate(dims, sizes, type, data, step, flags, usage);
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    ++allocations;
    return cv::Mat::getStdAllocator()->allocate(data, flags, usage);
  }
  void deallocate(cv::UMatData* data) const override { cv::Mat::getStdAllocator()->deallocate(data); }
};

/// What a robot runs with one method and the other.
std::vector<RepeatSettings> everySetting() {
  std::vector<RepeatSettings> all;
  for (const bool bucketed : {false, true}) {
    for (const auto method : {RegistrationMethod::kHistogram, RegistrationMethod::kRobust}) {
      RepeatSettings settings;
      settings.extraction = bucketed ? ExtractionSettings() : ExtractionSettings::published();
      settings.registration.method = method;
      all.push_back(settings);
    }
  }
  return all;
}

/// A robot runs for hours: after the first image only the result, two arrays, is allocated.
TEST(FeatureExtractor, keepsItsMemory) {
  const cv::Mat image = texture(400, 300, 81);
  const cv::Mat darker = 0.8 * image;
  FeatureExtractor extractor(ExtractionSettings::published());
  extractor.extract(image);
  const int before = allocations;
  const FeatureSet features = extractor.extract(darker);
  EXPECT_EQ(features.size(), 500U);
  EXPECT_EQ(allocations - before, 2);
}

/// The whole frame into memory that is there already: nothing at all is allocated.
TEST(WholeFrame, allocatesNothing) {
  const cv::Mat image = texture(640, 480, 82);
  const cv::Mat darker = 0.8 * image;
  for (const RepeatSettings& settings : everySetting()) {
    const auto registration = makeRegistration(settings.registration);
    FeatureExtractor extractor(settings.extraction);
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

/// Everything between an image and its velocity: also the choice between alternative maps and the place along
/// the path.
TEST(RepeatSession, stepsWithoutAllocating) {
  const cv::Mat wide = texture(700, 480, 83);
  const cv::Mat taught = wide(cv::Rect(20, 0, 640, 480));
  const cv::Mat left = wide(cv::Rect(0, 0, 640, 480));
  const cv::Mat right = wide(cv::Rect(35, 0, 640, 480));
  for (const RepeatSettings& settings : everySetting()) {
    MapMetadata metadata;
    metadata.extraction = settings.extraction.describe();
    metadata.length_m = 4.0;
    RepeatSession session(metadata, PathProfile::fromEntries({{0.0, {0.5, 0.0, 0.0}}}), 5, settings);
    session.beginTraversal(0.0, 0.0);
    FeatureExtractor extractor(settings.extraction);
    for (std::uint32_t index = 0; index < 5; ++index) {
      ActiveMap map{index, static_cast<double>(index), {}};
      for (const cv::Mat& image : {left, taught}) {
        map.alternatives.push_back({extractor.extract(image), {}});
        map.alternatives.back().positions.resize(map.alternatives.back().features.size());
      }
      session.add(std::move(map));
    }
    NavigationStep step;
    const auto drive = [&](double from_m) {
      for (int i = 0; i < 4; ++i) {
        const double travelled_m = from_m + 0.1 * i;
        session.stepInto(travelled_m, travelled_m, i % 2 == 0 ? right : taught, step);
        session.correctAlongPath(step);
      }
    };
    drive(1.7);
    const int before = allocations;
    drive(2.1);
    EXPECT_EQ(allocations - before, 0);
    EXPECT_EQ(step.local_map, 2U);
    EXPECT_EQ(step.registration.alternative, 1U);
    ASSERT_TRUE(step.registration.result.displacement_px);
    EXPECT_NEAR(*step.registration.result.displacement_px, 0.0, 0.5);
  }
}

}  // namespace
}  // namespace perennial

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  static perennial::CountingAllocator allocator;
  cv::Mat::setDefaultAllocator(&allocator);
  return RUN_ALL_TESTS();
}
