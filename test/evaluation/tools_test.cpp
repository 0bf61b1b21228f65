// Runs evaluate and report themselves, as a user does; EVALUATE and REPORT are their paths.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "perennial/core/csv.h"
#include "perennial/testing/temporary_folder.h"

namespace perennial {
namespace {

struct Result {
  int status = -1;
  std::string output;  // and errors
};

Result run(const std::string& command) {
  Result result;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  char buffer[4096];
  for (std::size_t count = 0; pipe != nullptr && (count = fread(buffer, 1, sizeof(buffer), pipe)) > 0;) {
    result.output.append(buffer, count);
  }
  result.status = WEXITSTATUS(pclose(pipe));
  return result;
}

std::string contentOf(const std::string& file) {
  std::ifstream stream(file);
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

class ToolsTest : public ::testing::Test {
 protected:
  static constexpr int kTraversals = 6;

  void SetUp() override {
    std::filesystem::create_directories(folder_ / "data");
    std::ofstream manifest(folder_ / "data/manifest.csv");
    manifest << "traversal,stamp,distance_m,image,offset_px\n";
    for (int t = 0; t < kTraversals; ++t) {
      cv::Mat noise(150, 400, CV_8UC1);
      cv::theRNG().state = 5;
      cv::randu(noise, 0, 256);
      cv::GaussianBlur(noise, noise, {0, 0}, 2.0);
      cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
      const std::string image = std::to_string(t) + ".png";
      cv::imwrite(folder_ / ("data/" + image), noise(cv::Rect(12 * t, 0, 300, 150)));
      manifest << "t" << t << ",2020-0" << t + 1 << "-01T12:00:00Z,0," << image << "," << -12 * t << "\n";
    }
    std::ofstream(folder_ / "sweep.yaml")
        << "runs:\n  - strategy: [static, latest]\n  - strategy: score_based\n"
           "    set: {exchange: [0.05, 0.5]}\n";
  }

  Result evaluate(const std::string& arguments) {
    return run(std::string(EVALUATE) + " " + folder_ / "data" + " --cache " + folder_ / "cache" + " " +
               arguments);
  }

  test_tools::TemporaryFolder folder_;
};

TEST_F(ToolsTest, aDataSetThatWasMadeAnewIsAnotherInput) {
  const std::string command = "--strategy static --out " + folder_ / "run";
  ASSERT_EQ(evaluate(command).status, 0);
  const std::string before = contentOf(folder_ / "run/errors.csv");
  std::string manifest = contentOf(folder_ / "data/manifest.csv");
  const std::size_t offset = manifest.find("1.png,-12");
  ASSERT_NE(offset, std::string::npos);
  std::ofstream(folder_ / "data/manifest.csv") << manifest.replace(offset, 9, "1.png,-13");
  const Result again = evaluate(command);
  ASSERT_EQ(again.status, 0) << again.output;
  EXPECT_NE(contentOf(folder_ / "run/errors.csv"), before);
}

TEST_F(ToolsTest, aSweepIsRunOnceAndReportedOn) {
  const std::string sweep = "--sweep " + folder_ / "sweep.yaml" + " --out " + folder_ / "runs";
  const Result first = evaluate(sweep);
  ASSERT_EQ(first.status, 0) << first.output;
  const std::string errors = folder_ / "runs/score_based,exchange=0.05/errors.csv";
  const CsvTable table = CsvTable::load(errors);
  ASSERT_EQ(table.rows().size(), std::size_t{kTraversals - 1});
  for (const CsvRow& row : table.rows()) {
    EXPECT_NEAR(table.number(row, "error_px"), 0.0, 2.0) << table.text(row, "traversal");
  }
  const auto written = std::filesystem::last_write_time(errors);
  std::filesystem::remove(folder_ / "runs/latest/summary.json");  // as if killed before it was complete
  const Result second = evaluate(sweep);
  ASSERT_EQ(second.status, 0) << second.output;
  EXPECT_EQ(std::filesystem::last_write_time(errors), written) << "a complete run is not repeated";
  EXPECT_TRUE(std::filesystem::exists(folder_ / "runs/latest/summary.json"));

  const Result report = run(std::string(REPORT) + " " + folder_ / "runs" + " --out " + folder_ / "report");
  ASSERT_EQ(report.status, 0) << report.output;
  for (const char* figure : {"distribution", "time", "drift", "frames", "lives", "cost"}) {
    for (const char* kind : {".png", ".svg", ".csv"}) {
      EXPECT_GT(std::filesystem::file_size(folder_ / ("report/" + std::string(figure) + kind)), 100U)
          << figure << kind;
    }
  }
  EXPECT_EQ(CsvTable::load(folder_ / "report/comparisons.csv").rows().size(), 6U) << "four runs in pairs";
  const std::string page = contentOf(folder_ / "report/report.html");
  for (const char* run : {"static", "latest", "exchange=0.5"}) {
    EXPECT_NE(page.find(run), std::string::npos) << run;
  }
  EXPECT_EQ(page.find("src=\"http"), std::string::npos) << "self-contained";
}

TEST_F(ToolsTest, pairsAreReportedOnWithTheReliabilityOfTheirConfidence) {
  for (const std::string method : {"robust", "histogram"}) {
    const Result pairs = run(std::string(EVALUATE) + " --pairs " + folder_ / "data" + " --out " +
                             folder_ / ("pairs/" + method) + " --set registration/method=" + method);
    ASSERT_EQ(pairs.status, 0) << pairs.output;
  }
  const Result report = run(std::string(REPORT) + " " + folder_ / "pairs" + " --out " + folder_ / "report");
  ASSERT_EQ(report.status, 0) << report.output;
  const CsvTable comparisons = CsvTable::load(folder_ / "report/comparisons.csv");
  ASSERT_EQ(comparisons.rows().size(), 1U);
  EXPECT_EQ(comparisons.number(comparisons.rows()[0], "pairs"), 15.0) << "each pair with itself";

  const CsvTable reliability = CsvTable::load(folder_ / "report/reliability.csv");
  for (const std::string method : {"robust", "histogram"}) {
    double answers = 0.0;
    double confidence = 0.0;
    for (const CsvRow& row : reliability.rows()) {
      if (reliability.text(row, "run") == method) {
        answers += reliability.number(row, "answers");
        confidence += reliability.number(row, "answers") * reliability.number(row, "mean_confidence");
        EXPECT_EQ(reliability.number(row, "share_right"), 1.0);
        EXPECT_LT(reliability.number(row, "low"), 1.0);
      }
    }
    double sum = 0.0;
    const CsvTable errors = CsvTable::load(folder_ / ("pairs/" + method + "/errors.csv"));
    for (const CsvRow& row : errors.rows()) {
      sum += errors.number(row, "confidence");
    }
    EXPECT_EQ(answers, 15.0) << method;
    EXPECT_NEAR(confidence, sum, 1e-3) << method;
  }
  EXPECT_GT(std::filesystem::file_size(folder_ / "report/reliability.png"), 1000U);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "report/lives.png")) << "pairs learn nothing";
}

TEST_F(ToolsTest, mistakesAreSaidBeforeAnythingIsDone) {
  const std::string out = " --out " + folder_ / "run";
  const Result unknown = evaluate("--strategy staitc" + out);
  EXPECT_EQ(unknown.status, 1);
  EXPECT_NE(unknown.output.find("score_based"), std::string::npos)
      << "lists those there are: " << unknown.output;
  const Result key = evaluate("--strategy score_based --set exchagne=0.1" + out);
  EXPECT_EQ(key.status, 1);
  EXPECT_NE(key.output.find("exchagne"), std::string::npos) << key.output;
  const Result range = evaluate("--strategy static --set registration/ratio=7" + out);
  EXPECT_EQ(range.status, 1);
  EXPECT_NE(range.output.find("[0, 1]"), std::string::npos) << range.output;
  EXPECT_EQ(evaluate("--strategy static").status, 1) << "no --out";
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run"));
}

TEST_F(ToolsTest, malformedTablesEndItBeforeAnythingIsDone) {
  const std::string header = "traversal,stamp,distance_m,image,offset_px\n";
  const std::string first = "t0,2020-01-01T12:00:00Z,0,0.png,0\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"traversal,stamp,distance_m,image\nt0,2020-01-01T12:00:00Z,0,0.png\n", "manifest.csv:1: "},
      {header + first + "t0,2020-02-01T12:00:00Z,0,1.png,0\n",
       "manifest.csv:3: traversal 't0' has this place already"},
      {header + first + "t1,2019-02-01T12:00:00Z,0,1.png,0\n", "manifest.csv:3: time goes backwards"},
      {header + first + "t1,yesterday,0,1.png,0\n", "manifest.csv:3: "}};
  for (const auto& [table, message] : cases) {
    std::ofstream(folder_ / "data/manifest.csv") << table;
    const Result result = evaluate("--strategy static --out " + folder_ / "run");
    EXPECT_EQ(result.status, 1);
    EXPECT_NE(result.output.find(message), std::string::npos) << result.output;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "run/summary.json"));
  }
}

TEST_F(ToolsTest, whatCannotBeUsedIsNamedAndTheSweepGoesOn) {
  cv::imwrite(folder_ / "data/4.png", cv::Mat(100, 300, CV_8UC1, cv::Scalar(9)));  // line 6: of another size
  std::ofstream(folder_ / "data/manifest.csv", std::ios::app)
      << "t3,2020-04-01T12:00:00Z,5,3.png,0\n";  // line 8
  const Result result =
      evaluate("--teach t0 --sweep " + folder_ / "sweep.yaml" + " --out " + folder_ / "runs");
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.output.find("manifest.csv:6: the image has another size"), std::string::npos)
      << result.output;
  EXPECT_NE(result.output.find("manifest.csv:8: the place at 5"), std::string::npos) << result.output;
  for (const char* run : {"static", "latest", "score_based,exchange=0.05", "score_based,exchange=0.5"}) {
    EXPECT_EQ(CsvTable::load(folder_ / ("runs/" + std::string(run) + "/errors.csv")).rows().size(),
              std::size_t{kTraversals - 2})
        << run;
  }
}

TEST_F(ToolsTest, aBadImageIsNamedAndTheRestGoesOn) {
  std::ofstream(folder_ / "data/3.png") << "no image";
  const Result result = evaluate("--strategy static --out " + folder_ / "run");
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.output.find("manifest.csv:5:"), std::string::npos) << result.output;
  EXPECT_EQ(CsvTable::load(folder_ / "run/errors.csv").rows().size(), std::size_t{kTraversals - 2});
}

}  // namespace
}  // namespace perennial
