#include "failing_calls.h"

#include <dlfcn.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

using perennial::FailingCalls;

bool armed = false;
FailingCalls::How manner = FailingCalls::How::kFail;
std::size_t call_to_fail = 0;
std::size_t calls_made = 0;
bool corrupted = false;

/// Counts a call; true when this is the one.
bool isTheOne() { return armed && ++calls_made == call_to_fail; }

/// Counts a call; false when it must fail.
bool goesOn() {
  if (!isTheOne() || manner == FailingCalls::How::kCorrupt) {
    return true;
  }
  if (manner == FailingCalls::How::kDie) {
    _exit(0);
  }
  errno = ENOSPC;
  return false;
}

template <typename Function>
Function original(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

/// Calls `write` with the bytes, or with one of them changed.
template <typename Write>
ssize_t writeOrFail(const void* bytes, std::size_t size, Write write) {
  if (armed && manner == FailingCalls::How::kCorrupt && calls_made + 1 == call_to_fail && size > 0) {
    ++calls_made;
    corrupted = true;
    const auto* begin = static_cast<const std::uint8_t*>(bytes);
    std::vector<std::uint8_t> changed(begin, begin + size);
    changed[size / 2] ^= 0x10;
    return write(changed.data());
  }
  return goesOn() ? write(bytes) : -1;
}

}  // namespace

namespace perennial {

void FailingCalls::arm(How how, std::size_t call) {
  manner = how;
  call_to_fail = call;
  calls_made = 0;
  corrupted = false;
  armed = true;
}
void FailingCalls::disarm() { armed = false; }
std::size_t FailingCalls::calls() { return calls_made; }
bool FailingCalls::hasCorrupted() { return corrupted; }

}  // namespace perennial

extern "C" {

ssize_t write(int descriptor, const void* bytes, std::size_t size) {
  static const auto call = original<ssize_t (*)(int, const void*, std::size_t)>("write");
  return writeOrFail(bytes, size, [&](const void* what) { return call(descriptor, what, size); });
}

ssize_t pwrite(int descriptor, const void* bytes, std::size_t size, off_t offset) {
  static const auto call = original<ssize_t (*)(int, const void*, std::size_t, off_t)>("pwrite");
  return writeOrFail(bytes, size, [&](const void* what) { return call(descriptor, what, size, offset); });
}

ssize_t pwrite64(int descriptor, const void* bytes, std::size_t size, off64_t offset) {
  static const auto call = original<ssize_t (*)(int, const void*, std::size_t, off64_t)>("pwrite64");
  return writeOrFail(bytes, size, [&](const void* what) { return call(descriptor, what, size, offset); });
}

int fsync(int descriptor) {
  static const auto call = original<int (*)(int)>("fsync");
  return goesOn() ? call(descriptor) : -1;
}

int ftruncate(int descriptor, off_t size) noexcept {
  static const auto call = original<int (*)(int, off_t)>("ftruncate");
  return goesOn() ? call(descriptor, size) : -1;
}

int fchmod(int descriptor, mode_t mode) noexcept {
  static const auto call = original<int (*)(int, mode_t)>("fchmod");
  return goesOn() ? call(descriptor, mode) : -1;
}

int link(const char* from, const char* to) noexcept {
  static const auto call = original<int (*)(const char*, const char*)>("link");
  if (armed && manner == FailingCalls::How::kNoLinks) {
    errno = EPERM;
    return -1;
  }
  return goesOn() ? call(from, to) : -1;
}

int statvfs(const char* path, struct statvfs* result) noexcept {
  static const auto call = original<int (*)(const char*, struct statvfs*)>("statvfs");
  const int status = call(path, result);
  if (armed && manner == FailingCalls::How::kNoRoom) {
    result->f_bavail = 0;
  }
  return status;
}

int rename(const char* from, const char* to) noexcept {
  static const auto call = original<int (*)(const char*, const char*)>("rename");
  return goesOn() ? call(from, to) : -1;
}

int unlink(const char* path) noexcept {
  static const auto call = original<int (*)(const char*)>("unlink");
  return goesOn() ? call(path) : -1;
}

}  // extern "C"
