// rosrun perennial_nav evaluate: replays a data set through what runs on the robot, under one strategy or
// many.
#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "tools/evaluate/evaluation.h"
#include "tools/evaluate/options.h"
#include "tools/evaluate/pairs_command.h"

int main(int argc, char** argv) {
  try {
    std::vector<std::string> arguments(argv + 1, argv + argc);
    if (arguments.empty() || std::count(arguments.begin(), arguments.end(), "--help") > 0) {
      std::cout << perennial::kEvaluateUsage << "\n" << perennial::kPairsUsage;
      return arguments.empty() ? 2 : 0;
    }
    const auto pairs = std::find(arguments.begin(), arguments.end(), "--pairs");
    if (pairs != arguments.end()) {
      arguments.erase(pairs);
      return perennial::evaluatePairsCommand(arguments);
    }
    return perennial::Evaluation(perennial::parseEvaluateOptions(arguments)).run() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "evaluate: " << error.what() << "\n";
    return 1;
  }
}
