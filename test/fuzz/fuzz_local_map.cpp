// Any bytes are either refused or a local map that is stored as the same bytes again.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "core/map/local_map_codec.h"
#include "perennial/core/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const perennial::Bytes bytes(data, data + size);
  try {
    if (perennial::encodeLocalMap(perennial::decodeLocalMap(bytes)) != bytes) {
      std::abort();
    }
  } catch (const perennial::MapError&) {
    // refused, as it should be
  }
  return 0;
}
