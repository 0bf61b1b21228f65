// With it, the C library's headers define open() themselves.
#undef _FORTIFY_SOURCE

#include "failing_calls.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "unsynced_changes.h"

namespace {

using perennial::FailingCalls;
using perennial::UnsyncedChanges;
using How = FailingCalls::How;

bool armed = false;
How manner = How::kFail;
std::size_t call_to_fail = 0;
std::size_t calls_made = 0;
bool corrupted = false;
std::unique_ptr<UnsyncedChanges> unsynced;  // of the manners that lose something
std::uint64_t seed = 0;

/// What we do to files ourselves is no call of the program's.
class Ourselves {
 public:
  Ourselves() : was_armed_(armed) { armed = false; }
  ~Ourselves() { armed = was_armed_; }
  Ourselves(const Ourselves&) = delete;
  Ourselves& operator=(const Ourselves&) = delete;

 private:
  bool was_armed_;
};

template <typename Function>
Function original(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

/// Counts a call; true when this is the one.
bool isTheOne() { return ++calls_made == call_to_fail; }

template <typename Where>
bool losesWhatIsIn(const Where& where) {
  if (!armed || !unsynced) {
    return false;
  }
  const Ourselves ourselves;
  return unsynced->concerns(where);
}

/// A call that changes something: counted, and made to fail when it is the one.
template <typename Call>
auto changeOrFail(Call call) -> decltype(call()) {
  const bool counts = armed && !unsynced;
  if (!counts || !isTheOne() || manner == How::kCorrupt) {
    return call();
  }
  if (manner == How::kDie) {
    _exit(0);
  }
  errno = ENOSPC;
  return -1;
}

/// `note` tells what the call will change in what is at `where`.
template <typename Where, typename Note, typename Call>
auto change(const Where& where, Note note, Call call) -> decltype(call()) {
  if (!losesWhatIsIn(where)) {
    return changeOrFail(call);
  }
  const std::size_t before = unsynced->names();
  {
    const Ourselves ourselves;
    note();
  }
  const auto result = call();
  if (result < 0) {
    unsynced->forgetNames(before);
  }
  if (manner == How::kLosePower && isTheOne()) {
    FailingCalls::losePower();
  }
  return result;
}

/// Calls `write` with the bytes, or with one of them changed.
template <typename Write>
ssize_t writeOrCorrupt(const void* bytes, std::size_t size, Write write) {
  if (armed && manner == How::kCorrupt && calls_made + 1 == call_to_fail && size > 0) {
    ++calls_made;
    corrupted = true;
    const auto* begin = static_cast<const std::uint8_t*>(bytes);
    std::vector<std::uint8_t> changed(begin, begin + size);
    changed[size / 2] ^= 0x10;
    return write(changed.data());
  }
  return changeOrFail([&] { return write(bytes); });
}

template <typename Write>
ssize_t writeTo(int descriptor, const void* bytes, std::size_t size, off_t offset, Write write) {
  if (!losesWhatIsIn(descriptor)) {
    return writeOrCorrupt(bytes, size, write);
  }
  return change(
      descriptor, [&] { unsynced->willWrite(descriptor, offset, size); }, [&] { return write(bytes); });
}

int sync(int descriptor, const char* name) {
  if (!losesWhatIsIn(descriptor)) {
    return changeOrFail([&] { return original<int (*)(int)>(name)(descriptor); });
  }
  if (isTheOne()) {
    if (manner == How::kLosePower) {
      FailingCalls::losePower();
    }
    const Ourselves ourselves;
    unsynced->loseContent(descriptor, seed);
    errno = EIO;
    return -1;
  }
  unsynced->synced(descriptor);
  return 0;  // the disk of this machine need not be bothered
}

template <typename Truncate>
int truncate(int descriptor, off_t size, Truncate truncate) {
  return change(
      descriptor, [&] { unsynced->willTruncate(descriptor, size); }, truncate);
}

template <typename Open>
int openFile(const char* path, int flags, Open open) {
  const bool creates =
      (flags & O_CREAT) != 0 && losesWhatIsIn(path) && faccessat(AT_FDCWD, path, F_OK, 0) != 0;
  return creates ? change(
                       path, [&] { unsynced->willCreate(path); }, open)
                 : open();
}

mode_t modeOf(int flags, va_list arguments) {
  const bool creates = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE;
  return creates ? static_cast<mode_t>(va_arg(arguments, unsigned int)) : 0;
}

template <typename Rename>
int renameFile(const char* from, const char* to, Rename rename) {
  return change(
      to, [&] { unsynced->willRename(from, to); }, rename);
}

}  // namespace

namespace perennial {

void FailingCalls::arm(How how, std::size_t call) {
  unsynced.reset();
  manner = how;
  call_to_fail = call;
  calls_made = 0;
  corrupted = false;
  armed = true;
}
void FailingCalls::armDisk(How how, std::size_t call, const std::string& folder, std::uint64_t chance) {
  arm(how, call);
  const Ourselves ourselves;
  unsynced = std::make_unique<UnsyncedChanges>(folder);
  seed = chance;
}
void FailingCalls::disarm() { armed = false; }
void FailingCalls::losePower() {
  armed = false;
  unsynced->lose(seed);
  _exit(kPowerLost);
}
std::size_t FailingCalls::calls() { return calls_made; }
bool FailingCalls::hasCorrupted() { return corrupted; }

}  // namespace perennial

extern "C" {

ssize_t write(int descriptor, const void* bytes, std::size_t size) {
  static const auto call = original<ssize_t (*)(int, const void*, std::size_t)>("write");
  return writeTo(descriptor, bytes, size, unsynced ? lseek(descriptor, 0, SEEK_CUR) : 0,
                 [&](const void* what) { return call(descriptor, what, size); });
}

ssize_t pwrite(int descriptor, const void* bytes, std::size_t size, off_t offset) {
  static const auto call = original<ssize_t (*)(int, const void*, std::size_t, off_t)>("pwrite");
  return writeTo(descriptor, bytes, size, offset,
                 [&](const void* what) { return call(descriptor, what, size, offset); });
}

ssize_t pwrite64(int descriptor, const void* bytes, std::size_t size, off64_t offset) {
  static const auto call = original<ssize_t (*)(int, const void*, std::size_t, off64_t)>("pwrite64");
  return writeTo(descriptor, bytes, size, offset,
                 [&](const void* what) { return call(descriptor, what, size, offset); });
}

int fsync(int descriptor) { return sync(descriptor, "fsync"); }

int fdatasync(int descriptor) { return sync(descriptor, "fdatasync"); }

int ftruncate(int descriptor, off_t size) noexcept {
  static const auto call = original<int (*)(int, off_t)>("ftruncate");
  return truncate(descriptor, size, [&] { return call(descriptor, size); });
}

int ftruncate64(int descriptor, off64_t size) noexcept {
  static const auto call = original<int (*)(int, off64_t)>("ftruncate64");
  return truncate(descriptor, size, [&] { return call(descriptor, size); });
}

int fchmod(int descriptor, mode_t mode) noexcept {
  static const auto call = original<int (*)(int, mode_t)>("fchmod");
  return changeOrFail([&] { return call(descriptor, mode); });
}

int open(const char* path, int flags, ...) {
  static const auto call = original<int (*)(const char*, int, mode_t)>("open");
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = modeOf(flags, arguments);
  va_end(arguments);
  return openFile(path, flags, [&] { return call(path, flags, mode); });
}

int open64(const char* path, int flags, ...) {
  static const auto call = original<int (*)(const char*, int, mode_t)>("open64");
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = modeOf(flags, arguments);
  va_end(arguments);
  return openFile(path, flags, [&] { return call(path, flags, mode); });
}

int link(const char* from, const char* to) noexcept {
  static const auto call = original<int (*)(const char*, const char*)>("link");
  if (armed && manner == FailingCalls::How::kNoLinks) {
    errno = EPERM;
    return -1;
  }
  return change(
      to, [&] { unsynced->willLink(to); }, [&] { return call(from, to); });
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
  return renameFile(from, to, [&] { return call(from, to); });
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned int flags) noexcept {
  static const auto call = original<int (*)(int, const char*, int, const char*, unsigned int)>("renameat2");
  return renameFile(from, to, [&] { return call(from_folder, from, to_folder, to, flags); });
}

int unlink(const char* path) noexcept {
  static const auto call = original<int (*)(const char*)>("unlink");
  return change(
      path, [&] { unsynced->willUnlink(path); }, [&] { return call(path); });
}

}  // extern "C"
