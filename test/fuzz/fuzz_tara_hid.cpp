// Any bytes as a reply to the driver and as a request to the camera's simulation.
#include <algorithm>
#include <cstdlib>

#include "perennial/core/drivers/tara_device.h"
#include "perennial/core/drivers/tara_hid_codec.h"

namespace {

void decodeEverything(const perennial::TaraReply& reply) {
  using namespace perennial;
  const auto setup = decodeTaraImuSetup(reply);
  if (setup && (static_cast<int>(setup->mode) == 2 || static_cast<int>(setup->mode) > 3)) {
    std::abort();
  }
  decodeTaraFirmware(reply);
  decodeTaraUniqueId(reply);
  decodeTaraExposure(reply);
  decodeTaraExposureSet(reply);
  decodeTaraImuSetupSet(reply);
  decodeTaraImuStream(reply);
  decodeTaraImuValues(reply);
  decodeTaraStreamMode(reply);
  decodeTaraStreamModeSet(reply);
  answers(reply, taraGetExposureRequest());
  answers(reply, taraFirmwareRequest());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace perennial;
  decodeEverything(TaraReply(data, data + size));
  TaraDevice device;
  TaraRequest request{};
  for (std::size_t begin = 0; begin < size; begin += request.size()) {
    request.fill(0);
    std::copy_n(data + begin, std::min(request.size(), size - begin), request.begin());
    const TaraReply reply = device.answer(request);
    if (!reply.empty() && !answers(reply, request) && request[1] == 0x78) {
      std::abort();
    }
    decodeEverything(reply);
  }
  return 0;
}
