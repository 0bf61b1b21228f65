#include "perennial/park/dataset_generator.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <utility>

#include "perennial/core/error.h"
#include "perennial/core/utc_time.h"
#include "perennial/park/random.h"
#include "perennial/park/renderer.h"

namespace perennial::park {
namespace {

constexpr double kDay_s = 86400.0;
constexpr int kMostExposures = 25;
enum Purpose : std::int64_t { kTimes = 1, kWeather = 2, kView = 3, kNoise = 4 };

std::string number(int value, int width) {
  std::ostringstream text;
  text << std::setw(width) << std::setfill('0') << value;
  return text.str();
}

Weather drawWeather(Random& random, double date_time_s) {
  const double day = dayOfYear(date_time_s);
  const bool winter = day < 80.0 || day > 325.0;
  const double dice = random.uniform();
  if (dice < 0.45) {
    return Weather::kClear;
  }
  if (dice < 0.8) {
    return Weather::kOvercast;
  }
  return winter && dice > 0.87 ? Weather::kSnow : Weather::kRain;
}

/// What makes one image of a place in a traversal.
struct View {
  CameraPose pose;
  int offset_px = 0;  ///< the image is cut so far to the right of the middle
};

class Generator {
 public:
  Generator(std::string folder, const GeneratedDatasetSettings& settings)
      : folder_(std::move(folder)),
        settings_(settings),
        path_(settings.loop),
        wide_(settings.camera),
        plan_(planTraversals(settings)) {
    wide_.geometry.width += 2 * settings.max_offset_px;
    wide_.geometry.cx += settings.max_offset_px;
  }

  void run(const std::function<void(std::size_t)>& progress) {
    requireSameSettings();
    for (std::size_t t = 0; t < plan_.size(); ++t) {
      if (!isComplete(t)) {
        photograph(t);
      }
      writeFile(folder_ + "/manifest.csv", manifest(t + 1));
      progress(t + 1);
    }
  }

 private:
  std::string imageOf(std::size_t traversal, int place) const {
    return plan_[traversal].name + "/" + number(place, 3) + ".png";
  }
  double distanceOf(int place) const { return path_.length() * place / settings_.places; }

  bool isComplete(std::size_t traversal) const {
    for (int place = 0; place < settings_.places; ++place) {
      if (!std::filesystem::exists(folder_ + "/" + imageOf(traversal, place))) {
        return false;
      }
    }
    return true;
  }

  View viewOf(std::size_t traversal, int place) const {
    Random random(mix({settings_.seed, kView, static_cast<std::int64_t>(traversal), place}));
    View view;
    view.offset_px = random.below(2 * settings_.max_offset_px + 1) - settings_.max_offset_px;
    const double along = settings_.position_error_m * random.normal();
    const double across = settings_.position_error_m * random.normal();
    const Pose pose = path_.at(distanceOf(place));
    view.pose.heading = pose.heading;
    view.pose.x = pose.x + along * std::cos(pose.heading) - across * std::sin(pose.heading);
    view.pose.y = pose.y + along * std::sin(pose.heading) + across * std::cos(pose.heading);
    view.pose.z = settings_.camera.height_m;
    return view;
  }

  /// All places of a traversal: the camera's exposure carries over from one to the next, as on a robot.
  void photograph(std::size_t traversal) {
    if (!renderer_) {
      renderer_ = std::make_unique<Renderer>(path_, wide_.geometry);
    }
    createFolder(folder_ + "/" + plan_[traversal].name);
    CameraModel camera(wide_, mix({settings_.seed, kNoise, static_cast<std::int64_t>(traversal)}));
    std::int64_t shots = 0;
    for (int place = 0; place < settings_.places; ++place) {
      const View view = viewOf(traversal, place);
      cv::Mat image;
      for (int i = 0; i < kMostExposures && (i == 0 || !camera.state().settled); ++i) {
        const cv::Mat& rendered =
            renderer_->render(plan_[traversal].conditions, view.pose, camera.exposure());
        image = camera.develop(rendered, 0.0, shots++, false);
      }
      const cv::Rect cut(settings_.max_offset_px + view.offset_px, 0, settings_.camera.geometry.width,
                         image.rows);
      writeImage(folder_ + "/" + imageOf(traversal, place), image(cut));
    }
  }

  std::string manifest(std::size_t traversals) const {
    std::ostringstream text;
    text << "traversal,stamp,distance_m,image,offset_px\n";
    for (std::size_t t = 0; t < traversals; ++t) {
      for (int place = 0; place < settings_.places; ++place) {
        text << plan_[t].name << "," << formatUtc(plan_[t].conditions.date_time_s) << "," << distanceOf(place)
             << "," << imageOf(t, place) << "," << -viewOf(t, place).offset_px << "\n";
      }
    }
    return text.str();
  }

  /// Everything that the images depend on.
  std::string description() const {
    std::ostringstream text;
    text << "places " << settings_.places << "\ntraversals " << settings_.traversals << "\ndays "
         << settings_.days << "\nseed " << settings_.seed << "\nstart " << formatUtc(settings_.start_s)
         << "\nmax_offset_px " << settings_.max_offset_px << "\nposition_error_m "
         << settings_.position_error_m << "\nimage " << settings_.camera.geometry.width << "x"
         << settings_.camera.geometry.height << "\n";
    return text.str();
  }

  void requireSameSettings() const {
    createFolder(folder_);
    const std::string file = folder_ + "/settings.txt";
    std::ifstream stream(file);
    if (stream) {
      std::ostringstream known;
      known << stream.rdbuf();
      if (known.str() != description()) {
        throw Error(folder_ +
                    " holds a data set of other settings (see settings.txt in it); choose another folder");
      }
      return;
    }
    writeFile(file, description());
  }

  static void createFolder(const std::string& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) {
      throw Error("the folder " + folder + " cannot be created: " + error.message());
    }
  }

  static void writeFile(const std::string& file, const std::string& content) {
    std::ofstream stream(file + ".partial");
    stream << content;
    stream.close();
    if (!stream || std::rename((file + ".partial").c_str(), file.c_str()) != 0) {
      throw Error(file + " cannot be written");
    }
  }

  static void writeImage(const std::string& file, const cv::Mat& image) {
    const std::string partial = file + ".partial.png";
    if (!cv::imwrite(partial, image) || std::rename(partial.c_str(), file.c_str()) != 0) {
      throw Error(file + " cannot be written");
    }
  }

  std::string folder_;
  GeneratedDatasetSettings settings_;
  LoopPath path_;
  CameraSettings wide_;
  std::vector<PlannedTraversal> plan_;
  std::unique_ptr<Renderer> renderer_;  ///< made when something is to be rendered
};

}  // namespace

std::vector<PlannedTraversal> planTraversals(const GeneratedDatasetSettings& settings) {
  Random times(mix({settings.seed, kTimes}));
  std::vector<double> offsets_s = {0.0};
  while (offsets_s.size() < static_cast<std::size_t>(settings.traversals)) {
    offsets_s.push_back(std::ceil(times.uniform(0.0, settings.days * kDay_s)));
  }
  std::sort(offsets_s.begin(), offsets_s.end());
  std::vector<PlannedTraversal> plan;
  for (std::size_t t = 0; t < offsets_s.size(); ++t) {
    Random random(mix({settings.seed, kWeather, static_cast<std::int64_t>(t)}));
    PlannedTraversal traversal;
    traversal.name = number(static_cast<int>(t), 3);
    traversal.conditions.date_time_s = settings.start_s + offsets_s[t];
    traversal.conditions.world_seed = settings.seed;
    traversal.conditions.wind_m_s = random.uniform(0.0, 8.0);
    traversal.conditions.weather =
        t == 0 ? Weather::kClear : drawWeather(random, traversal.conditions.date_time_s);
    plan.push_back(traversal);
  }
  return plan;
}

void generateDataset(const std::string& folder, const GeneratedDatasetSettings& settings,
                     const std::function<void(std::size_t)>& progress) {
  Generator(folder, settings).run(progress);
}

}  // namespace perennial::park
