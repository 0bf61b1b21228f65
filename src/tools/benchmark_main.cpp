// rosrun perennial_nav benchmark: times of every stage and of the whole frame, beside other libraries' in the
// same run. Names read stage/size/features/path, for instance whole_frame/752x480/500/avx2. All options of
// Google Benchmark apply
// (--benchmark_filter, --benchmark_format=json, ...).
#include <benchmark/benchmark.h>

#include <cstdio>
#include <map>
#include <memory>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#ifdef PERENNIAL_HAS_DLIB
#include <dlib/array2d.h>
#include <dlib/image_keypoint.h>
#endif

#include "core/features/brief_descriptor.h"
#include "core/features/edge_field_extractor.h"
#include "core/features/half_image.h"
#include "core/features/hessian_pyramid.h"
#include "core/features/integral_image.h"
#include "core/features/maxima.h"
#include "core/features/surf_detector.h"
#include "core/registration/edge_correlation.h"
#include "core/simd/kernels.h"
#include "perennial/core/feature_extractor.h"
#include "perennial/core/place_finder.h"
#include "perennial/core/registration.h"
#include "perennial/testing/synthetic_place.h"

namespace perennial {
namespace {

/// One measurement's circumstances.
struct Case {
  cv::Size size;
  int features;
  const Kernels* path;  ///< nullptr for another library's code
};

/// An image with structure of every size, as outdoor scenes have; always the same.
cv::Mat scene(const cv::Size& size) {
  cv::RNG random(7);
  cv::Mat sum(size, CV_32F, cv::Scalar(128.0));
  for (int cell = 2; cell <= size.height / 4; cell *= 2) {
    cv::Mat coarse(size.height / cell + 2, size.width / cell + 2, CV_32F);
    random.fill(coarse, cv::RNG::NORMAL, 0.0, 18.0);
    cv::Mat fine;
    cv::resize(coarse, fine, {coarse.cols * cell, coarse.rows * cell}, 0.0, 0.0, cv::INTER_CUBIC);
    sum += fine(cv::Rect({0, 0}, size));
  }
  cv::Mat image;
  sum.convertTo(image, CV_8U);
  return image;
}

ExtractionSettings extraction(int features, bool spread) {
  ExtractionSettings settings = spread ? ExtractionSettings() : ExtractionSettings::published();
  settings.features = features;
  return settings;
}

void integral(benchmark::State& state, const Case& c) {
  const cv::Mat image = scene(c.size);
  IntegralImage table;
  for (auto _ : state) {
    table.compute(image);
    benchmark::DoNotOptimize(table.row(0));
  }
}

void hessian(benchmark::State& state, const Case& c) {
  IntegralImage table;
  table.compute(scene(c.size));
  HessianPyramid pyramid(4, 3);
  for (auto _ : state) {
    pyramid.compute(table);
    benchmark::ClobberMemory();
  }
}

void detect(benchmark::State& state, const Case& c) {
  IntegralImage table;
  table.compute(scene(c.size));
  SurfDetector detector(extraction(c.features, false));
  for (auto _ : state) {
    benchmark::DoNotOptimize(detector.detect(table, BriefDescriptor::kMargin).data());
  }
}

void describe(benchmark::State& state, const Case& c) {
  IntegralImage table;
  table.compute(scene(c.size));
  const std::vector<Keypoint> keypoints =
      SurfDetector(extraction(c.features, false)).detect(table, BriefDescriptor::kMargin);
  BriefDescriptor brief;
  for (auto _ : state) {
    brief.prepare(table);
    for (const Keypoint& keypoint : keypoints) {
      benchmark::DoNotOptimize(brief.describe(nearestPixel(keypoint)));
    }
  }
}

/// All of an image's features, and its edges where the settings want them.
void extract(benchmark::State& state, const Case& c, bool spread) {
  const cv::Mat image = scene(c.size);
  FeatureExtractor extractor(extraction(c.features, spread));
  FeatureSet view;
  for (auto _ : state) {
    extractor.extractInto(image, view);
    benchmark::ClobberMemory();
  }
}

void edgeField(benchmark::State& state, const Case& c) {
  cv::Mat half;
  halveImage(scene(c.size), half);
  EdgeFieldExtractor extractor;
  EdgeField field;
  for (auto _ : state) {
    extractor.compute(half, field);
    benchmark::ClobberMemory();
  }
}

void edgeCorrelation(benchmark::State& state, const Case& c) {
  const EdgeField field = edgeFieldOf(scene(c.size));
  EdgeCorrelation correlation;
  for (auto _ : state) {
    benchmark::DoNotOptimize(correlation.compute(field, field));
  }
}

/// The registration against features of the scene as seen 30 px further left.
class Against {
 public:
  Against(const Case& c, RegistrationMethod method, bool spread)
      : image_(scene(c.size)),
        extractor_(extraction(c.features, spread)),
        registration_(makeRegistration({method})) {
    const cv::Mat shifted = (cv::Mat_<double>(2, 3) << 1, 0, -30, 0, 1, 0);
    cv::Mat moved;
    cv::warpAffine(image_, moved, shifted, c.size, cv::INTER_NEAREST, cv::BORDER_REFLECT);
    map_ = extractor_.extract(moved);
    extractor_.extractInto(image_, view_);
  }

  void registerView() { registration_->registerInto(map_, view_, workspace_, result_); }
  void frame() {
    extractor_.extractInto(image_, view_);
    registerView();
  }

 private:
  cv::Mat image_;
  FeatureExtractor extractor_;
  std::unique_ptr<Registration> registration_;
  FeatureSet map_;
  FeatureSet view_;
  RegistrationWorkspace workspace_;
  RegistrationResult result_;
};

void matchAndVote(benchmark::State& state, const Case& c, RegistrationMethod method, bool spread) {
  Against against(c, method, spread);
  for (auto _ : state) {
    against.registerView();
    benchmark::ClobberMemory();
  }
}

void wholeFrame(benchmark::State& state, const Case& c, RegistrationMethod method, bool spread) {
  Against against(c, method, spread);
  for (auto _ : state) {
    against.frame();
    benchmark::ClobberMemory();
  }
}

/// Local maps of a path on which every metre looks different, 0.2 m apart.
const std::vector<std::shared_ptr<const ActiveMap>>& thousandLocalMaps() {
  static const std::vector<std::shared_ptr<const ActiveMap>> maps = [] {
    std::vector<std::shared_ptr<const ActiveMap>> result;
    for (std::uint32_t index = 0; index < 1000; ++index) {
      auto map = std::make_shared<ActiveMap>();
      map->index = index;
      map->distance_m = 0.2 * index;
      map->alternatives.emplace_back();
      map->alternatives.front().features = test_tools::SyntheticPlace(index / 5, 600).view(0.0, 0.0, 500);
      result.push_back(std::move(map));
    }
    return result;
  }();
  return maps;
}

void findPlace(benchmark::State& state, const Case& c) {
  const auto& maps = thousandLocalMaps();
  const FeatureSet view =
      test_tools::SyntheticPlace(123, 600).view(0.0, 40.0, static_cast<std::size_t>(c.features));
  PlaceFinder finder;
  for (auto _ : state) {
    finder.seek(view);
    for (const auto& map : maps) {
      finder.consider(map);
    }
    benchmark::DoNotOptimize(finder.guess().distance_m);
  }
}

void opencvOrb(benchmark::State& state, const Case& c) {
  const cv::Mat image = scene(c.size);
  const auto orb = cv::ORB::create(c.features);
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  for (auto _ : state) {
    orb->detectAndCompute(image, cv::noArray(), keypoints, descriptors);
  }
}

void opencvMatcher(benchmark::State& state, const Case& c) {
  cv::Mat map(c.features, 32, CV_8UC1);
  cv::Mat view(c.features, 32, CV_8UC1);
  cv::randu(map, 0, 256);
  cv::randu(view, 0, 256);
  const cv::BFMatcher matcher(cv::NORM_HAMMING);
  std::vector<std::vector<cv::DMatch>> matches;
  for (auto _ : state) {
    matcher.knnMatch(map, view, matches, 2);
  }
}

#ifdef PERENNIAL_HAS_DLIB
void dlibSurf(benchmark::State& state, const Case& c) {
  const cv::Mat image = scene(c.size);
  dlib::array2d<unsigned char> copy(image.rows, image.cols);
  for (int y = 0; y < image.rows; ++y) {
    std::copy_n(image.ptr<unsigned char>(y), image.cols, &copy[y][0]);
  }
  for (auto _ : state) {
    dlib::integral_image table;
    table.load(copy);
    dlib::hessian_pyramid pyramid;
    pyramid.build_pyramid(table, 4, 6, 2);
    std::vector<dlib::interest_point> points;
    dlib::get_interest_points(pyramid, 0.1, points);
    benchmark::DoNotOptimize(points.data());
  }
}
#endif

template <class Function>
void add(const std::string& stage, const Case& c, Function function) {
  const std::string name = stage + "/" + std::to_string(c.size.width) + "x" + std::to_string(c.size.height) +
                           "/" + std::to_string(c.features) + "/" +
                           (c.path != nullptr ? c.path->name : "library");
  benchmark::RegisterBenchmark(name.c_str(), [c, function](benchmark::State& state) {
    useKernels(c.path != nullptr ? *c.path : *availableKernels().back());
    function(state, c);
  })->Unit(benchmark::kMillisecond);
}

void addPath(const Case& c) {
  using Method = RegistrationMethod;
  add("integral", c, integral);
  add("hessian", c, hessian);
  add("detect", c, detect);
  add("describe", c, describe);
  add("edge_field", c, edgeField);
  add("edge_correlation", c, edgeCorrelation);
  const auto features = [](bool spread) {
    return [spread](benchmark::State& s, const Case& k) { extract(s, k, spread); };
  };
  add("extract", c, features(false));
  add("extract_default", c, features(true));
  const auto method = [](Method m, bool spread) {
    return [m, spread](benchmark::State& s, const Case& k) { matchAndVote(s, k, m, spread); };
  };
  add("register_histogram", c, method(Method::kHistogram, false));
  add("register_robust", c, method(Method::kRobust, false));
  add("register_default", c, method(Method::kRobust, true));
  const auto frame = [](Method m, bool spread) {
    return [m, spread](benchmark::State& s, const Case& k) { wholeFrame(s, k, m, spread); };
  };
  add("whole_frame", c, frame(Method::kHistogram, false));
  add("whole_frame_robust", c, frame(Method::kRobust, true));
}

void addAll() {
  for (const cv::Size& size :
       {cv::Size(376, 240), cv::Size(752, 480), cv::Size(1024, 384), cv::Size(1920, 1080)}) {
    for (const int features : {250, 500, 1000, 2000}) {
      const Case library{size, features, nullptr};
      add("opencv_orb", library, opencvOrb);
      add("opencv_bfmatcher", library, opencvMatcher);
#ifdef PERENNIAL_HAS_DLIB
      add("dlib_surf_detect", library, dlibSurf);
#endif
      for (const Kernels* path : availableKernels()) {
        addPath({size, features, path});
        if (size == cv::Size(752, 480) && features == 500) {
          add("find_place_of_1000", {size, features, path}, findPlace);
        }
      }
    }
  }
}

/// Prints as usual and remembers times, for the ratios afterwards.
class Reporter : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      if (run.run_type == Run::RT_Iteration) {
        auto& least = times_.emplace(run.benchmark_name(), run.GetAdjustedCPUTime()).first->second;
        least = std::min(least, run.GetAdjustedCPUTime());
      }
    }
  }

  /// How many times as long as ours the others took, and our own scalar path, of the same size and features;
  /// by the time of the processor, which does not count what other programs take.
  void printRatios() const {
    for (const auto& [name, ms] : times_) {
      const std::size_t slash = name.find('/');
      const std::string stage = name.substr(0, slash);
      const std::string circumstances = name.substr(slash, name.rfind('/') - slash);
      ratio(name, ms, stage + circumstances + "/scalar");
      ratio(name, ms,
            (stage == "detect"              ? "dlib_surf_detect"
             : stage.rfind("whole", 0) == 0 ? "opencv_orb"
                                            : "none") +
                circumstances + "/library");
      if (stage == "whole_frame") {
        ratio(name, ms, "dlib_surf_detect" + circumstances + "/library");
      }
      if (stage.rfind("register", 0) == 0) {
        ratio(name, ms, "opencv_bfmatcher" + circumstances + "/library");
      }
    }
  }

 private:
  void ratio(const std::string& ours, double ms, const std::string& other) const {
    const auto found = times_.find(other);
    if (found != times_.end() && other != ours && ours.find("/library") == std::string::npos) {
      std::printf("%-45s %8.2f times as fast as %s\n", ours.c_str(), found->second / ms, other.c_str());
    }
  }

  std::map<std::string, double> times_;
};

}  // namespace
}  // namespace perennial

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  perennial::addAll();
  // Ratios stand below the table; machine-readable formats are left as they are.
  bool console = true;
  for (int i = 1; i < argc; ++i) {
    console = console && std::string(argv[i]).rfind("--benchmark_format=", 0) != 0;
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return 1;
  }
  if (!console) {
    benchmark::RunSpecifiedBenchmarks();
    return 0;
  }
  perennial::Reporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  reporter.printRatios();
  return 0;
}
