// Draws two pictures with the backend named by the argument (osmesa or egl; without an argument osmesa) and
// prints a hash of their bytes. backends.cpp runs this program with
// several settings of environment variables.
#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>

#include "scenes.h"

#include <pliant/render/renderer.h>

int main(int argc, char** argv) try {
  const bool egl = argc > 1 && std::string(argv[1]) == "egl";
  pliant::test::Scene scene;
  pliant::Renderer renderer(333, 251, egl ? pliant::GlBackend::egl : pliant::GlBackend::osmesa);
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a
  for (int i = 0; i < 2; ++i) {
    for (const std::uint8_t byte : renderer.draw(scene.picture).rgb) hash = (hash ^ byte) * 1099511628211u;
    scene.color_by_height();
  }
  std::printf("%016llx\n", static_cast<unsigned long long>(hash));
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
