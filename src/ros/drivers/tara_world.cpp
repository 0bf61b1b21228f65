#include "perennial/ros/drivers/tara_world.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "perennial/core/error.h"

namespace perennial {

std::string taraWorldFile(const std::string& folder) { return folder + "/world"; }

TaraWorld& mapTaraWorld(const std::string& folder, bool create) {
  const std::string file = taraWorldFile(folder);
  const int descriptor = open(file.c_str(), create ? O_RDWR | O_CREAT | O_TRUNC : O_RDWR, 0600);
  if (descriptor < 0) {
    throw Error(file + ": cannot be opened");
  }
  void* memory = MAP_FAILED;
  if (!create || ftruncate(descriptor, sizeof(TaraWorld)) == 0) {
    memory = mmap(nullptr, sizeof(TaraWorld), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  }
  close(descriptor);
  if (memory == MAP_FAILED) {
    throw Error(file + ": cannot be mapped");
  }
  return *static_cast<TaraWorld*>(memory);  // a new file is all zeros, which is a good initial state
}

}  // namespace perennial
