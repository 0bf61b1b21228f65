// A library to be preloaded into a node (LD_PRELOAD): while the file named by FULL_DISK exists, writing to
// maps and to SQLite's temporary files fails as on a full disk.
#include <dlfcn.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>

namespace {

template <typename Function>
Function original(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

bool isFull(int descriptor) {
  const char* flag = std::getenv("FULL_DISK");
  if (flag == nullptr || access(flag, F_OK) != 0) {
    return false;
  }
  char target[4096];
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  const ssize_t size = readlink(link.c_str(), target, sizeof(target));
  const std::string file(target, size > 0 ? static_cast<std::size_t>(size) : 0);
  return file.find(".perennial") != std::string::npos || file.find("etilqs_") != std::string::npos;
}

template <typename Result>
Result refuse() {
  errno = ENOSPC;
  return static_cast<Result>(-1);
}

}  // namespace

extern "C" {

ssize_t write(int descriptor, const void* bytes, std::size_t size) {
  static const auto call = original<ssize_t (*)(int, const void*, std::size_t)>("write");
  return isFull(descriptor) ? refuse<ssize_t>() : call(descriptor, bytes, size);
}

ssize_t pwrite(int descriptor, const void* bytes, std::size_t size, off_t offset) {
  static const auto call = original<ssize_t (*)(int, const void*, std::size_t, off_t)>("pwrite");
  return isFull(descriptor) ? refuse<ssize_t>() : call(descriptor, bytes, size, offset);
}

ssize_t pwrite64(int descriptor, const void* bytes, std::size_t size, off64_t offset) {
  static const auto call = original<ssize_t (*)(int, const void*, std::size_t, off64_t)>("pwrite64");
  return isFull(descriptor) ? refuse<ssize_t>() : call(descriptor, bytes, size, offset);
}

}  // extern "C"
