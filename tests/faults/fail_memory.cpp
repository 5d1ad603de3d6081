// A library for LD_PRELOAD. It counts the calls that allocate memory, and all calls from a given number on
// fail. PLIANT_FAIL_MEMORY_FROM: number of the first call that fails, counted from the start of main().
// PLIANT_COUNT_MEMORY: name of the file to which the number of calls during main() is written when main()
// returns.
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include <dlfcn.h>

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace {

std::atomic<bool> counting{false};
std::atomic<long> calls{0};
long first_failure = std::numeric_limits<long>::max();

bool fails() {
  if (!counting || ++calls < first_failure) return false;
  errno = ENOMEM;
  return true;
}

using Main = int (*)(int, char**, char**);
Main real_main = nullptr;

int counted_main(int argc, char** argv, char** environment) {
  if (const char* from = std::getenv("PLIANT_FAIL_MEMORY_FROM")) first_failure = std::atol(from);
  counting = true;
  const int code = real_main(argc, argv, environment);
  counting = false;
  if (const char* name = std::getenv("PLIANT_COUNT_MEMORY"))
    if (std::FILE* file = std::fopen(name, "w")) {
      std::fprintf(file, "%ld", calls.load());
      std::fclose(file);
    }
  return code;
}

}  // namespace

extern "C" {

void* malloc(std::size_t size) {
  return fails() ? nullptr : __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  return fails() ? nullptr : __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  return fails() ? nullptr : __libc_realloc(block, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  return fails() ? nullptr : __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return fails() ? nullptr : __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  if (fails()) return ENOMEM;
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}

int __libc_start_main(Main program, int argc, char** argv, Main begin, void (*end)(), void (*loader_end)(),
                      void* stack_end) {
  real_main = program;
  const auto next = reinterpret_cast<decltype(&__libc_start_main)>(dlsym(RTLD_NEXT, "__libc_start_main"));
  return next(counted_main, argc, argv, begin, end, loader_end, stack_end);
}

}  // extern "C"
