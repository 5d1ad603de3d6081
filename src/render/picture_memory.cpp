// The memory for a picture, and the limits of this process.
#include <algorithm>
#include <cmath>
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
/// Memory for a GL library with its compiler and its depth maps, bytes, and the addresses that it reserves.
constexpr double kBytesOfLibrary = 150e6, kAddressesOfLibrary = 650e6;

/// Throws OutOfMemory if a picture needs more memory than this process can have. needed, available: bytes.
/// limit: name of the limit, for the message.
void require(const std::string& picture, double needed, double available, const char* limit) {
  if (needed <= available) return;
  auto gigabytes = [](double bytes) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f GB", bytes / 1e9);
    return std::string(text);
  };
  throw OutOfMemory(picture + " needs about " + gigabytes(needed) + " of memory, and this process can have " +
                    gigabytes(std::max(0.0, available)) + " (" + limit +
                    "); choose a smaller size with --size");
}

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

/// Returns the memory that the control group (version 2) of this process still allows, bytes; infinity
/// without a limit.
double memory_of_group() {
  double available = std::numeric_limits<double>::infinity();
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    if (line.compare(0, 3, "0::") != 0) continue;
    const std::string folder = "/sys/fs/cgroup" + line.substr(3);
    double most = 0;
    const double used = number_after(folder + "/memory.stat", "anon");
    if (std::isfinite(used) && std::ifstream(folder + "/memory.max") >> most) available = most - used;
  }
  return available;
}

/// Returns a limit of this process, bytes; infinity if there is none.
template <class Resource>
double limit_of(Resource resource) {
  rlimit most{};
  const bool limited = ::getrlimit(resource, &most) == 0 && most.rlim_cur != RLIM_INFINITY;
  return limited ? static_cast<double>(most.rlim_cur) : std::numeric_limits<double>::infinity();
}

}  // namespace

void require_picture_memory(int width, int height) {
  const std::string picture =
      "a picture of " + std::to_string(width) + " x " + std::to_string(height) + " pixels";
  const double pixels = kBytesPerPixel * width * height, needed = kBytesOfLibrary + pixels;
  const double kilobytes = number_after("/proc/meminfo", "MemAvailable:") +
                           std::min(number_after("/proc/meminfo", "SwapFree:"), 1e15);
  require(picture, needed, 1024 * kilobytes, "the free memory of this machine");
  require(picture, needed, memory_of_group(), "the limit of its control group");
  double pages = 0, skipped = 0, data_pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> skipped >> skipped >> skipped >> skipped >> data_pages;
  const auto page = static_cast<double>(::sysconf(_SC_PAGESIZE));
  require(picture, needed, limit_of(RLIMIT_DATA) - page * data_pages, "the limit of its data, ulimit -d");
  require(picture, kAddressesOfLibrary + pixels, limit_of(RLIMIT_AS) - page * pages,
          "the limit of its address space, ulimit -v");
}

}  // namespace pliant
