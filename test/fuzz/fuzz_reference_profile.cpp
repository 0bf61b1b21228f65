// Any YAML is refused or read as a path profile of the reference system: finite, with distances that rise.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "perennial/core/error.h"
#include "perennial/core/reference_map.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string content = "%YAML:1.0\n---\n" + std::string(data, data + size);
  try {
    const perennial::PathProfile profile = perennial::decodeReferenceProfile(content, "fuzz.yaml");
    const auto& entries = profile.entries();
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const perennial::Velocity& velocity = entries[i].velocity;
      const bool rises = i == 0 || entries[i].distance_m > entries[i - 1].distance_m;
      if (!rises || !std::isfinite(entries[i].distance_m + velocity.forward) ||
          !(profile.at(entries[i].distance_m) == velocity)) {
        std::abort();
      }
    }
    if (entries.empty()) {
      std::abort();
    }
  } catch (const perennial::DatasetError&) {
    // refused, as it should be
  }
  return 0;
}
