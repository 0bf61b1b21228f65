#pragma once

#include <string>
#include <vector>

namespace perennial {

extern const char kPairsUsage[];

/// evaluate --pairs: `arguments` without "--pairs". Returns the exit status; throws Error.
int evaluatePairsCommand(const std::vector<std::string>& arguments);

}  // namespace perennial
