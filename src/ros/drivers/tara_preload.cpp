// A library to be preloaded into the TARA's driver (LD_PRELOAD, with TARA_SIMULATION naming the folder of a
// tara_simulator): device files below that folder's dev behave as the camera's V4L2 node and its two hidraw
// nodes, so that the unchanged driver runs without the hardware, nor a kernel module.
//
// The V4L2 node is an eventfd, readable while frames wait, with its buffers in a memfd; a hidraw node is one
// end of a socket pair. Everything else goes on to the C library.
#include <dlfcn.h>
#include <fcntl.h>
#include <linux/hidraw.h>
#include <linux/videodev2.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "perennial/ros/drivers/tara_simulated_hid.h"
#include "perennial/ros/drivers/tara_simulated_video.h"

namespace {

using perennial::TaraSimulatedHid;
using perennial::TaraSimulatedVideo;

template <typename Function>
Function original(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

/// The simulated devices that are open in this process. Never destroyed: other threads may use it to the very
/// end. The simulator must live as long as the driver, since its world is mapped once.
struct Simulation {
  std::recursive_mutex mutex;  ///< recursive, since making a device calls functions that are replaced below
  perennial::TaraWorld* world = nullptr;
  std::string folder;
  std::unique_ptr<TaraSimulatedHid> hid;
  std::map<int, std::shared_ptr<TaraSimulatedVideo>> videos;
  std::map<int, int> hid_descriptor_sizes;

  static Simulation& instance() {
    static auto* simulation = new Simulation();
    return *simulation;
  }

  Simulation() {
    const char* variable = std::getenv("TARA_SIMULATION");
    folder = variable == nullptr ? "" : variable;
  }

  bool owns(const char* path) const {
    return !folder.empty() && path != nullptr &&
           std::strncmp(path, (folder + "/dev/").c_str(), folder.size() + 5) == 0;
  }

  int open(const std::string& path) {
    const std::lock_guard<std::recursive_mutex> lock(mutex);
    if (world == nullptr) {
      world = &perennial::mapTaraWorld(folder, false);
    }
    if (world->unplugged != 0) {
      errno = ENOENT;
      return -1;
    }
    if (!hid) {
      hid = std::make_unique<TaraSimulatedHid>(*world);
    }
    if (path.find("video") != std::string::npos) {
      auto video = std::make_shared<TaraSimulatedVideo>(*world);
      videos[video->descriptor()] = video;
      return video->descriptor();
    }
    const bool is_control = path.find("hidraw0") != std::string::npos;
    const int descriptor = is_control ? hid->openControl() : hid->openImu();
    hid_descriptor_sizes[descriptor] =
        is_control ? perennial::kTaraControlDescriptorSize : perennial::kTaraImuDescriptorSize;
    return descriptor;
  }

  std::shared_ptr<TaraSimulatedVideo> video(int descriptor) {
    const std::lock_guard<std::recursive_mutex> lock(mutex);
    const auto found = videos.find(descriptor);
    return found == videos.end() ? nullptr : found->second;
  }

  void forget(int descriptor) {
    std::shared_ptr<TaraSimulatedVideo> last;  // ends after the lock: it closes descriptors, too
    const std::lock_guard<std::recursive_mutex> lock(mutex);
    const auto found = videos.find(descriptor);
    if (found != videos.end()) {
      last = std::move(found->second);
      videos.erase(found);
    }
    hid_descriptor_sizes.erase(descriptor);
  }

  int hidControl(int descriptor, unsigned long request, void* argument) {
    const std::lock_guard<std::recursive_mutex> lock(mutex);
    const auto found = hid_descriptor_sizes.find(descriptor);
    if (found == hid_descriptor_sizes.end()) {
      return -2;  // not ours
    }
    if (request == HIDIOCGRDESCSIZE) {
      *static_cast<int*>(argument) = found->second;
      return 0;
    }
    if (request == HIDIOCGRDESC) {
      auto* descriptor_bytes = static_cast<hidraw_report_descriptor*>(argument);
      std::memset(descriptor_bytes->value, 0, static_cast<std::size_t>(found->second));
      return 0;
    }
    errno = ENOTTY;
    return -1;
  }
};

int openAnywhere(const char* name, const char* path, int flags, va_list arguments) {
  if (Simulation::instance().owns(path)) {
    return Simulation::instance().open(path);
  }
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, mode_t) : 0;
  return original<int (*)(const char*, int, ...)>(name)(path, flags, mode);
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const int descriptor = openAnywhere("open", path, flags, arguments);
  va_end(arguments);
  return descriptor;
}

int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const int descriptor = openAnywhere("open64", path, flags, arguments);
  va_end(arguments);
  return descriptor;
}

int __open_2(const char* path, int flags) { return open(path, flags); }
int __open64_2(const char* path, int flags) { return open64(path, flags); }

int ioctl(int descriptor, unsigned long request, ...) {
  va_list arguments;
  va_start(arguments, request);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  if (const auto video = Simulation::instance().video(descriptor)) {
    return video->control(request, argument);
  }
  const int by_hid = Simulation::instance().hidControl(descriptor, request, argument);
  return by_hid != -2 ? by_hid
                      : original<int (*)(int, unsigned long, void*)>("ioctl")(descriptor, request, argument);
}

void* mmap(void* address, std::size_t length, int protection, int flags, int descriptor, off_t offset) {
  static const auto call = original<void* (*)(void*, std::size_t, int, int, int, off_t)>("mmap");
  if (descriptor >= 0) {
    if (const auto video = Simulation::instance().video(descriptor)) {
      return call(address, length, protection, flags, video->memory(), offset);
    }
  }
  return call(address, length, protection, flags, descriptor, offset);
}

void* mmap64(void* address, std::size_t length, int protection, int flags, int descriptor, off64_t offset) {
  return mmap(address, length, protection, flags, descriptor, offset);
}

int close(int descriptor) {
  static const auto call = original<int (*)(int)>("close");
  Simulation::instance().forget(descriptor);
  return call(descriptor);
}

}  // extern "C"
