// The memory for a picture, and the limits of this process.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include <sys/resource.h>
#include <unistd.h>

#include <pliant/body/step_failure.h>
#include <pliant/render/renderer.h>

namespace pliant {
namespace {

/// Memory for a pixel, bytes: four samples of colour and depth in GL, the same samples of colour read from
/// GL, the image, and its PNG file in the worst case.
constexpr double kBytesPerPixel = 16 + 16 + 16 + 3 + 3;
/// Memory for a GL library with its compiler and its depth maps, bytes.
constexpr double kBytesOfLibrary = 300e6;

/// An amount of memory that this process can still get, and what limits it.
struct Limit {
  double bytes = std::numeric_limits<double>::infinity();
  const char* what = "";

  void keep_smaller(double other, const char* what_other) {
    if (other < bytes) *this = {std::max(0.0, other), what_other};
  }
};

/// Returns the number after a word in a file of lines "WORD NUMBER ...", or infinity.
double number_after(const std::string& file, const std::string& word) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    std::string first;
    double number = 0;
    if (words >> first && first == word && words >> number) return number;
  }
  return std::numeric_limits<double>::infinity();
}

/// Limits the memory by that of the control group of this process, in version 2 of the control groups.
void limit_by_group(Limit& limit) {
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    if (line.compare(0, 3, "0::") != 0) continue;
    const std::string folder = "/sys/fs/cgroup" + line.substr(3);
    double most = 0;
    const double used = number_after(folder + "/memory.stat", "anon");
    if (std::ifstream(folder + "/memory.max") >> most && std::isfinite(used))
      limit.keep_smaller(most - used, "the limit of its control group");
  }
}

Limit available_memory() {
  Limit limit;
  const double kilobyte = 1024;
  const double free_memory = number_after("/proc/meminfo", "MemAvailable:");
  if (std::isfinite(free_memory))
    limit.keep_smaller(kilobyte * (free_memory + number_after("/proc/meminfo", "SwapFree:")),
                       "the free memory of this machine");
  double pages = 0, skipped = 0, data_pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> skipped >> skipped >> skipped >> skipped >> data_pages;
  const auto page = static_cast<double>(::sysconf(_SC_PAGESIZE));
  rlimit most{};
  if (::getrlimit(RLIMIT_AS, &most) == 0 && most.rlim_cur != RLIM_INFINITY)
    limit.keep_smaller(static_cast<double>(most.rlim_cur) - page * pages,
                       "the limit of its address space, ulimit -v");
  if (::getrlimit(RLIMIT_DATA, &most) == 0 && most.rlim_cur != RLIM_INFINITY)
    limit.keep_smaller(static_cast<double>(most.rlim_cur) - page * data_pages,
                       "the limit of its data, ulimit -d");
  limit_by_group(limit);
  return limit;
}

std::string gigabytes(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f GB", bytes / 1e9);
  return text;
}

}  // namespace

void require_picture_memory(int width, int height) {
  const double needed = kBytesOfLibrary + kBytesPerPixel * width * height;
  const Limit limit = available_memory();
  if (needed <= limit.bytes) return;
  throw OutOfMemory("a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                    " pixels needs about " + gigabytes(needed) + " of memory, and this process can have " +
                    gigabytes(limit.bytes) + " (" + limit.what + "); choose a smaller size with --size");
}

}  // namespace pliant
