#include "perennial/core/matches_picture.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace perennial {
namespace {

const cv::Scalar kBackground(32, 32, 32);
const cv::Scalar kText(235, 235, 235);
const cv::Scalar kAxis(150, 150, 150);
const cv::Scalar kCorrect(80, 200, 60);
const cv::Scalar kIncorrect(60, 60, 230);
const cv::Scalar kUnmatched(190, 170, 90);
constexpr int kGap = 8;                // px between the images
constexpr int kHeader = 30;            // px for the line of text on top
constexpr int kHistogram = 150;        // px for the histogram below
constexpr double kLineOpacity = 0.35;  // of few lines; hundreds must not hide the images
constexpr int kFewLines = 40;
constexpr int kShownHalf = 20;  // bins shown on each side of 0, at least

void write(cv::Mat& canvas, const std::string& text, cv::Point where, double size = 0.5,
           const cv::Scalar& colour = kText) {
  cv::putText(canvas, text, where, cv::FONT_HERSHEY_SIMPLEX, size, colour, 1, cv::LINE_AA);
}

void writeCentred(cv::Mat& canvas, const std::string& text, cv::Point where, double size) {
  int baseline = 0;
  const cv::Size extent = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, 1, &baseline);
  write(canvas, text, {where.x - extent.width / 2, where.y}, size);
}

cv::Mat inColour(const cv::Mat& image, cv::Size size_if_empty) {
  cv::Mat colour;
  if (image.empty()) {
    return {size_if_empty, CV_8UC3, cv::Scalar::all(96)};
  }
  cv::cvtColor(image, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

cv::Point at(const Keypoint& keypoint, cv::Point offset) {
  return {cvRound(keypoint.x) + offset.x, cvRound(keypoint.y) + offset.y};
}

void drawFeatures(cv::Mat& canvas, const FeatureSet& features, cv::Point offset) {
  for (const Keypoint& keypoint : features.keypoints) {
    cv::circle(canvas, at(keypoint, offset), 2, kUnmatched, 1, cv::LINE_AA);
  }
}

void drawPairs(cv::Mat& canvas, const FeatureSet& map, const FeatureSet& view,
               const RegistrationResult& result, FeatureState state, cv::Point map_offset,
               cv::Point view_offset, bool lines) {
  const cv::Scalar& colour = state == FeatureState::kMatchedCorrectly ? kCorrect : kIncorrect;
  for (std::size_t i = 0; i < result.states.size(); ++i) {
    if (result.states[i] != state || result.partners[i] < 0) {
      continue;
    }
    const cv::Point from = at(map.keypoints[i], map_offset);
    const cv::Point to = at(view.keypoints[static_cast<std::size_t>(result.partners[i])], view_offset);
    if (lines) {
      cv::line(canvas, from, to, colour, 1, cv::LINE_AA);
    } else {
      cv::circle(canvas, from, 3, colour, cv::FILLED, cv::LINE_AA);
      cv::circle(canvas, to, 3, colour, cv::FILLED, cv::LINE_AA);
    }
  }
}

double lineOpacity(int lines) {
  return kLineOpacity * std::sqrt(1.0 * kFewLines / std::max(kFewLines, lines));
}

/// Right-aligned, on one line.
void drawLegend(cv::Mat& canvas, int baseline_y) {
  const std::vector<std::pair<std::string, cv::Scalar>> entries{
      {"not matched", kUnmatched}, {"matched, disagrees", kIncorrect}, {"matched, agrees", kCorrect}};
  int right = canvas.cols - 8;
  for (const auto& [text, colour] : entries) {
    int baseline = 0;
    right -= cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, 0.4, 1, &baseline).width;
    write(canvas, text, {right, baseline_y}, 0.4);
    cv::circle(canvas, {right - 9, baseline_y - 4}, 3, colour, cv::FILLED, cv::LINE_AA);
    right -= 32;
  }
}

std::string headline(const RegistrationResult& result) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1);
  if (result.displacement_px) {
    text << "displacement " << std::showpos << *result.displacement_px << std::noshowpos << " px";
  } else {
    text << "no displacement";
  }
  text << "    " << result.inliers << " of " << result.matches << " pairs agree    " << result.states.size()
       << " map features";
  return text.str();
}

void drawHistogram(cv::Mat canvas, const RegistrationResult& result) {
  const DisplacementHistogram& histogram = result.histogram;
  const int shown = std::max(kShownHalf, histogram.half());
  const int bottom = canvas.rows - 24;
  const double step = static_cast<double>(canvas.cols) / (2 * shown + 1);
  const auto x_of = [&](double bin) { return cvRound((bin + shown + 0.5) * step); };
  const int fullest =
      histogram.counts.empty() ? 0 : *std::max_element(histogram.counts.begin(), histogram.counts.end());
  cv::line(canvas, {0, bottom}, {canvas.cols, bottom}, kAxis);
  for (std::size_t position = 0; position < histogram.counts.size(); ++position) {
    const int bin = static_cast<int>(position) - histogram.half();
    const int height = (bottom - 22) * histogram.counts[position] / std::max(1, fullest);
    const double centre = histogram.centre(position);
    const bool agrees =
        result.displacement_px && std::abs(centre - *result.displacement_px) <= 1.5 * histogram.bin_width_px;
    if (height > 0) {
      cv::rectangle(canvas, {x_of(bin - 0.42), bottom - height}, {x_of(bin + 0.42), bottom - 1},
                    agrees ? kCorrect : kIncorrect, cv::FILLED);
    }
  }
  const int label_every = std::max(5, shown / 4 / 5 * 5);
  for (int bin = -shown / label_every * label_every; bin <= shown; bin += label_every) {
    cv::line(canvas, {x_of(bin), bottom}, {x_of(bin), bottom + 4}, kAxis);
    writeCentred(canvas, std::to_string(cvRound(bin * histogram.bin_width_px)), {x_of(bin), bottom + 18},
                 0.4);
  }
  write(canvas, "votes (fullest bin: " + std::to_string(fullest) + ") by x_map - x_view [px]", {6, 14}, 0.4);
}

}  // namespace

cv::Mat drawMatches(const cv::Mat& map_image, const cv::Mat& view_image, const FeatureSet& map,
                    const FeatureSet& view, const RegistrationResult& result) {
  const cv::Mat left = inColour(map_image, view_image.size());
  const cv::Mat right = inColour(view_image, map_image.size());
  const int images_height = std::max(left.rows, right.rows);
  cv::Mat canvas(kHeader + images_height + kHistogram, left.cols + kGap + right.cols, CV_8UC3, kBackground);
  const cv::Point map_offset(0, kHeader);
  const cv::Point view_offset(left.cols + kGap, kHeader);
  left.copyTo(canvas(cv::Rect(map_offset, left.size())));
  right.copyTo(canvas(cv::Rect(view_offset, right.size())));
  drawFeatures(canvas, map, map_offset);
  drawFeatures(canvas, view, view_offset);
  cv::Mat with_lines = canvas.clone();
  for (const bool lines : {true, false}) {
    for (const FeatureState state : {FeatureState::kMatchedCorrectly, FeatureState::kMatchedIncorrectly}) {
      drawPairs(lines ? with_lines : canvas, map, view, result, state, map_offset, view_offset, lines);
    }
    if (lines) {
      const double opacity = lineOpacity(result.matches);
      cv::addWeighted(with_lines, opacity, canvas, 1.0 - opacity, 0.0, canvas);
    }
  }
  write(canvas, "map", {8, 20});
  write(canvas, "view     " + headline(result), {view_offset.x + 8, 20});
  drawHistogram(canvas.rowRange(kHeader + images_height, canvas.rows), result);
  drawLegend(canvas, kHeader + images_height + 14);
  return canvas;
}

}  // namespace perennial
