// Pictures are identical with OSMesa and EGL, and with any number of raster threads.
#include <sys/wait.h>

#include <cstdio>
#include <string>
#include <thread>

#include "catch.h"
#include "scenes.h"

#include <pliant/render/renderer.h>

namespace backends_test {

using namespace pliant;

namespace {

bool opens(const GlBackend backend) {
  const char* start = backend == GlBackend::osmesa ? "OSMesa" : "EGL";
  for (const GlProbe& probe : probe_gl_backends())
    if (probe.opened && probe.name.rfind(start, 0) == 0) return true;
  return false;
}

// Runs the program render_digest and returns the last line of its output, a hash of two pictures.
// environment: settings of environment variables; backend: osmesa or egl.
std::string digest(const std::string& environment, const std::string& backend) {
  const std::string command = "env " + environment + " '" PLIANT_RENDER_DIGEST "' " + backend;
  FILE* pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe);
  char line[256] = "";
  while (std::fgets(line, sizeof line, pipe)) {
  }
  const int status = ::pclose(pipe);
  INFO(command);
  REQUIRE(WIFEXITED(status));
  REQUIRE(WEXITSTATUS(status) == 0);
  return line;
}

}  // namespace

TEST_CASE("every backend is probed, and gives a reason if it does not open") {
  const std::vector<GlProbe> probes = probe_gl_backends();
  REQUIRE(probes.size() == 3);
  for (const GlProbe& probe : probes) {
    CAPTURE(probe.name, probe.reason);
    CHECK(probe.opened == probe.reason.empty());
    CHECK(probe.opened != probe.version.empty());
    CHECK(probe.opened != probe.renderer.empty());
  }
}

TEST_CASE("OSMesa and EGL give identical bytes, side by side in one process") {
  if (!opens(GlBackend::osmesa) || !opens(GlBackend::egl)) {
    WARN("not compared: the test needs libosmesa6, and libegl1 with libgl1-mesa-dri");
    return;
  }
  test::Scene scene;
  Renderer a(320, 240, GlBackend::osmesa), b(320, 240, GlBackend::egl);
  CHECK(a.backend() == "OSMesa");
  CHECK(b.backend().rfind("EGL", 0) == 0);
  const Image first = a.draw(scene.picture);
  CHECK(first.rgb == b.draw(scene.picture).rgb);
  CHECK(first.rgb == a.draw(scene.picture).rgb);
  scene.color_by_height();
  const Image colored = a.draw(scene.picture);
  CHECK(colored.rgb != first.rgb);
  CHECK(colored.rgb == b.draw(scene.picture).rgb);
}

TEST_CASE("the number of raster threads does not change a byte") {
  for (const std::string backend : {"osmesa", "egl"}) {
    if (!opens(backend == "osmesa" ? GlBackend::osmesa : GlBackend::egl)) {
      WARN("not tested: " << backend << " does not open here");
      continue;
    }
    const std::string one = digest("LP_NUM_THREADS=1", backend);
    CHECK(one.size() > 8);
    for (const char* setting : {"LP_NUM_THREADS=0", "LP_NUM_THREADS=2", "LP_NUM_THREADS=7"}) {
      CAPTURE(backend, setting);
      CHECK(digest(setting, backend) == one);
    }
  }
}

TEST_CASE("a renderer may be used by several threads in turn, and several renderers may exist") {
  const test::Scene scene;
  Renderer a(64, 48), b(64, 48);
  const Image first = a.draw(scene.picture);
  Image other;
  std::thread([&] { other = a.draw(scene.picture); }).join();
  CHECK(first.rgb == other.rgb);
  CHECK(first.rgb == b.draw(scene.picture).rgb);
}

}  // namespace backends_test
