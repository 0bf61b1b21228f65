// Any YAML is refused or read as a local map of the reference system. The line that OpenCV insists on comes
// first, as without it nearly every input would end there.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "perennial/core/error.h"
#include "perennial/core/reference_map.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string content = "%YAML:1.0\n---\n" + std::string(data, data + size);
  try {
    const perennial::ReferenceLocalMap map = perennial::decodeReferenceMap(content, "fuzz.yaml");
    const bool rated = !map.ratings.empty();
    if (map.features.descriptors.size() != map.features.keypoints.size() ||
        (rated && map.ratings.size() != map.features.keypoints.size())) {
      std::abort();
    }
  } catch (const perennial::DatasetError&) {
    // refused, as it should be
  }
  return 0;
}
