// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// Makes one call of the system fail in a program under LD_PRELOAD, the first of its kind being that
// behind the start of main:
//
//   LAMINA_FAULT=memory:N   the N-th request for memory finds none
//   LAMINA_FAULT=write:N    the N-th write fails with EIO
//   LAMINA_FAULT=short:N    the N-th write writes half of its bytes
//   LAMINA_FAULT=space:N    the N-th write and all after it fail with ENOSPC
//   LAMINA_FAULT=sync:N     the N-th fsync fails with EIO
//   LAMINA_FAULT=read:N     the N-th read, fread or pread of a file fails with EIO
//
// fwrite counts as write.
//
//   LAMINA_FAULT_LOG=FILE   at the end how many calls there were; at the fault, and at a crash, who
//   called
#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace {

enum Kind { memory, writing, syncing, reading, kinds };
constexpr const char* kind_names[kinds] = {"memory", "write", "sync", "read"};

std::atomic<bool> is_in_main{false};
std::atomic<long> calls[kinds];
Kind wanted_kind = kinds;
enum { eio, half, nospc } wanted_way = eio;
long wanted_call = 0;

template <class Function>
Function* next_of(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

using Write = ssize_t(int, const void*, std::size_t);
using Read = ssize_t(int, void*, std::size_t);
using PlaceRead = ssize_t(int, void*, std::size_t, off_t);
using StreamRead = std::size_t(void*, std::size_t, std::size_t, std::FILE*);
using StreamWrite = std::size_t(const void*, std::size_t, std::size_t, std::FILE*);
using Sync = int(int);
Write* real_write = nullptr;
Read* real_read = nullptr;
Sync* real_fsync = nullptr;
PlaceRead* real_pread = nullptr;
StreamRead* real_fread = nullptr;
StreamWrite* real_fwrite = nullptr;

/// The frames of who called, by modules and offsets; takes no memory.
void log_frames(const char* title) {
  const char* file = std::getenv("LAMINA_FAULT_LOG");
  if (!file) return;
  is_in_main = false;  // what follows is not the program's
  void* frames[24];
  const int count = backtrace(frames, 24);
  const int log = open(file, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  (void)!real_write(log, title, std::strlen(title));
  backtrace_symbols_fd(frames, count, log);
  close(log);
  is_in_main = true;
}

/// Whether this call of a kind is to fail.
bool fails(Kind kind) {
  if (!is_in_main) return false;
  const long call = ++calls[kind];
  if (kind != wanted_kind) return false;
  if (call == wanted_call) log_frames("fault\n");
  return call == wanted_call || (wanted_way == nospc && call > wanted_call);
}

void* memory_or_null(void* (*get)(std::size_t, std::size_t), std::size_t a, std::size_t b) {
  if (fails(memory)) {
    errno = ENOMEM;
    return nullptr;
  }
  return get(a, b);
}

/// As the C library does on an error: ferror() is true from now on.
void mark_failed(std::FILE* stream, int error) {
  stream->_flags |= 0x20;
  errno = error;
}

bool is_file(int descriptor) {
  struct stat status {};
  return fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

void read_wish() {
  const char* wish = std::getenv("LAMINA_FAULT");
  if (!wish) return;
  const char* colon = std::strchr(wish, ':');
  if (!colon) return;
  wanted_call = std::atol(colon + 1);
  const auto is = [&](const char* name) {
    return std::strncmp(wish, name, static_cast<std::size_t>(colon - wish)) == 0;
  };
  wanted_kind = is("memory") ? memory : is("sync") ? syncing : is("read") ? reading : writing;
  wanted_way = is("short") ? half : is("space") ? nospc : eio;
}

void on_crash(int number) {
  log_frames("crash\n");
  signal(number, SIG_DFL);
  raise(number);
}

using Main = int(int, char**, char**);
Main* real_main = nullptr;

int main_with_faults(int argc, char** argv, char** environment) {
  for (const int number : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL}) signal(number, on_crash);
  is_in_main = true;
  return real_main(argc, argv, environment);
}

/// Says what a run without faults has had.
struct AtExit {
  AtExit() {
    void* frames[1];
    backtrace(frames, 1);  // loads what it needs
    real_write = next_of<Write>("write");
    real_read = next_of<Read>("read");
    real_fsync = next_of<Sync>("fsync");
    real_pread = next_of<PlaceRead>("pread");
    real_fread = next_of<StreamRead>("fread");
    real_fwrite = next_of<StreamWrite>("fwrite");
    read_wish();
  }
  ~AtExit() {
    is_in_main = false;
    const char* file = std::getenv("LAMINA_FAULT_LOG");
    if (!file || wanted_kind != kinds) return;
    if (std::FILE* log = std::fopen(file, "w")) {
      for (int kind = 0; kind < kinds; ++kind)
        std::fprintf(log, "%s %ld\n", kind_names[kind], calls[kind].load());
      std::fclose(log);
    }
  }
} at_exit;

}  // namespace

extern "C" {

int __libc_start_main(Main* main, int argc, char** argv, void (*init)(), void (*fini)(),
                      void (*rtld_fini)(), void* stack_end) {
  real_main = main;
  using Start = int(Main*, int, char**, void (*)(), void (*)(), void (*)(), void*);
  return next_of<Start>("__libc_start_main")(main_with_faults, argc, argv, init, fini, rtld_fini,
                                             stack_end);
}

void* malloc(std::size_t size) {
  return memory_or_null([](std::size_t, std::size_t s) { return __libc_malloc(s); }, 0, size);
}
void* calloc(std::size_t count, std::size_t size) {
  return memory_or_null(__libc_calloc, count, size);
}
void* realloc(void* old, std::size_t size) {
  if (fails(memory)) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  return memory_or_null(__libc_memalign, alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
int posix_memalign(void** result, std::size_t alignment, std::size_t size) {
  void* found = memalign(alignment, size);
  if (!found) return ENOMEM;
  *result = found;
  return 0;
}

ssize_t write(int descriptor, const void* bytes, std::size_t count) {
  if (!fails(writing)) return real_write ? real_write(descriptor, bytes, count) : -1;
  if (wanted_way == half && count > 1) return real_write(descriptor, bytes, count / 2);
  errno = wanted_way == nospc ? ENOSPC : EIO;
  return wanted_way == half ? real_write(descriptor, bytes, count) : -1;
}

ssize_t read(int descriptor, void* bytes, std::size_t count) {
  if (!is_file(descriptor) || !fails(reading)) return real_read(descriptor, bytes, count);
  errno = EIO;
  return -1;
}

ssize_t pread(int descriptor, void* bytes, std::size_t count, off_t at) {
  if (!fails(reading)) return real_pread(descriptor, bytes, count, at);
  errno = EIO;
  return -1;
}

std::size_t fread(void* bytes, std::size_t size, std::size_t count, std::FILE* stream) {
  if (!fails(reading)) return real_fread(bytes, size, count, stream);
  mark_failed(stream, EIO);
  return 0;
}

std::size_t fwrite(const void* bytes, std::size_t size, std::size_t count, std::FILE* stream) {
  if (!fails(writing)) return real_fwrite(bytes, size, count, stream);
  mark_failed(stream, wanted_way == nospc ? ENOSPC : EIO);
  return wanted_way == half ? real_fwrite(bytes, size, count / 2, stream) : 0;
}

int fsync(int descriptor) {
  if (!fails(syncing)) return real_fsync(descriptor);
  errno = EIO;
  return -1;
}

}  // extern "C"
