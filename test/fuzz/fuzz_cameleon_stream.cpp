// Any bytes, then a good status: the parser must find the good one, account for every byte, and never read
// beyond its buffer. The robot's side must take any bytes as commands, too.
#include <algorithm>
#include <cstdlib>
#include <optional>

#include "perennial/core/drivers/cameleon_codec.h"
#include "perennial/core/drivers/cameleon_status_parser.h"

namespace {

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void decodeCommands(const std::uint8_t* data, std::size_t size) {
  using namespace perennial;
  CameleonCommandBytes bytes;
  for (; size >= bytes.size(); data += bytes.size(), size -= bytes.size()) {
    std::copy_n(data, bytes.size(), bytes.begin());
    if (const auto command = decodeCommand(bytes)) {
      const auto again = decodeCommand(encode(*command));
      require(again && std::abs(again->forward) <= kCameleonMaxForward &&
              std::abs(again->turn) <= kCameleonMaxTurn && std::abs(again->flipper) <= kCameleonMaxFlipper);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace perennial;
  CameleonStatusParser parser;
  for (std::size_t i = 0; i < size; ++i) {
    parser.push(data[i]);
  }
  const CameleonStatus good{true, 12345, -6789, 3, -4, 45, 77};
  std::optional<CameleonStatus> last;
  for (const std::uint8_t byte : encode(good)) {
    last = parser.push(byte);
  }
  require(last && *last == good);
  require(parser.counters().stray_bytes + kCameleonStatusSize * parser.counters().frames ==
          size + kCameleonStatusSize);
  decodeCommands(data, size);
  return 0;
}
