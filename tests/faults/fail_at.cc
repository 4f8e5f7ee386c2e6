// Interposed under a program (LD_PRELOAD): the N-th call of one kind that concerns a directory
// fails, or with FAIL_ON that and every later one.
//   FAIL_UNDER=DIR FAIL_CALL=open|write|fsync|rename FAIL_AT=N [FAIL_ERRNO=28] [FAIL_ON=1]

#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <sys/types.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace {

std::atomic<int> calls{0};

const char* Setting(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

bool Under(const char* path) {
  const char* directory = Setting("FAIL_UNDER");
  return *directory && path && std::strncmp(path, directory, std::strlen(directory)) == 0;
}

bool Under(int fd) {
  char link[64], path[4096];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t size = ::readlink(link, path, sizeof path - 1);
  if (size < 0) return false;
  path[size] = '\0';
  return Under(path);
}

/// True when this call is the one that fails; sets errno.
bool Fails(const char* call, bool concerns) {
  if (!concerns || std::strcmp(Setting("FAIL_CALL"), call) != 0) return false;
  const int call_number = ++calls, first = std::atoi(Setting("FAIL_AT"));
  if (*Setting("FAIL_ON") ? call_number < first : call_number != first) return false;
  const char* number = Setting("FAIL_ERRNO");
  errno = *number ? std::atoi(number) : ENOSPC;
  return true;
}

template <typename Function>
Function Real(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  static const auto real = Real<int (*)(const char*, int, ...)>("open");
  return Fails("open", Under(path)) ? -1 : real(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  static const auto real = Real<int (*)(const char*, int, ...)>("open64");
  return Fails("open", Under(path)) ? -1 : real(path, flags, mode);
}

FILE* fopen(const char* path, const char* mode) {
  static const auto real = Real<FILE* (*)(const char*, const char*)>("fopen");
  return Fails("open", Under(path)) ? nullptr : real(path, mode);
}

FILE* fopen64(const char* path, const char* mode) {
  static const auto real = Real<FILE* (*)(const char*, const char*)>("fopen64");
  return Fails("open", Under(path)) ? nullptr : real(path, mode);
}

ssize_t write(int fd, const void* data, size_t size) {
  static const auto real = Real<ssize_t (*)(int, const void*, size_t)>("write");
  return Fails("write", Under(fd)) ? -1 : real(fd, data, size);
}

int fsync(int fd) {
  static const auto real = Real<int (*)(int)>("fsync");
  return Fails("fsync", Under(fd)) ? -1 : real(fd);
}

int rename(const char* from, const char* to) {
  static const auto real = Real<int (*)(const char*, const char*)>("rename");
  return Fails("rename", Under(to)) ? -1 : real(from, to);
}

int renameat2(int from_fd, const char* from, int to_fd, const char* to, unsigned flags) {
  static const auto real = Real<int (*)(int, const char*, int, const char*, unsigned)>("renameat2");
  return Fails("rename", Under(to)) ? -1 : real(from_fd, from, to_fd, to, flags);
}

}  // extern "C"
