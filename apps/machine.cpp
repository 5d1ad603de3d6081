// Processor features, loaded BLAS libraries, programs in PATH, and the text of --version.
#include "machine.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <unistd.h>

#include <pliant/io/format/png.h>
#include <pliant/io/run/build_info.h>

namespace pliant_cli {

std::string processor_features() {
  std::string features;
#if defined(__x86_64__)
  const auto add = [&](bool there, const char* name) {
    if (there) features += (features.empty() ? "" : " ") + std::string(name);
  };
  __builtin_cpu_init();
  add(__builtin_cpu_supports("sse4.2"), "sse4.2");
  add(__builtin_cpu_supports("avx"), "avx");
  add(__builtin_cpu_supports("avx2"), "avx2");
  add(__builtin_cpu_supports("fma"), "fma");
  add(__builtin_cpu_supports("avx512f"), "avx512f");
#endif
  return features;
}

std::string loaded_blas() {
  std::ifstream maps("/proc/self/maps");
  std::set<std::string> libraries;
  for (std::string line; std::getline(maps, line);) {
    const std::string name = std::filesystem::path(line.substr(line.rfind(' ') + 1)).filename().string();
    if (name.find("blas") != std::string::npos) libraries.insert(name);
  }
  std::string text;
  for (const std::string& name : libraries) text += (text.empty() ? "" : " ") + name;
  return text.empty() ? "none" : text;
}

std::string find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::string candidate = (std::filesystem::path(folder) / name).string();
    if (::access(candidate.c_str(), X_OK) == 0) return candidate;
  }
  return {};
}

std::string version_text() {
  std::string text;
  for (const auto& [name, value] : pliant::build_info()) text += name + " " + value + "\n";
  const std::string features = processor_features();
  if (!features.empty()) text += "processor features of this machine: " + features + "\n";
  text += std::string("libpng ") + pliant::png_library_version() + "\n";
  text +=
      "licence of the sources: MIT. Eigen is MPL-2, nlohmann-json MIT, CLI11 BSD-3; libpng has its own "
      "permissive licence.\n"
#ifdef PLIANT_HAS_SUITESPARSE
      "SuiteSparse is linked: AMD is BSD-3, the core of CHOLMOD LGPL-2.1+ and its supernodal module GPL-2+. "
      "This program "
      "is therefore distributed under the terms of the GPL.\n"
#else
      "SuiteSparse is not linked.\n"
#endif
      "window: GLFW has the zlib licence, Dear ImGui MIT (pliant doctor reports whether they are linked).\n"
      "graphics: OSMesa or EGL, opened only when a picture is requested (pliant doctor lists the available "
      "ones).\n";
  return text;
}

}  // namespace pliant_cli
