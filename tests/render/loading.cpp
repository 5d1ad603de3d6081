// OpenGL is loaded when the first renderer is created, not earlier. The checks depend on their order and must
// run in one process. They are in one test case, because ctest starts a new process for each case.
#include <fstream>
#include <string>

#include "catch.h"
#include "scenes.h"

#include <pliant/io/format/png.h>
#include <pliant/render/renderer.h>

namespace loading_test {

using namespace pliant;

namespace {

// Returns the line of /proc/self/maps of the first library that belongs to OpenGL or to an implementation of
// OpenGL; empty if there is none.
std::string mapped_gl_library() {
  std::ifstream maps("/proc/self/maps");
  REQUIRE(maps);
  for (std::string line; std::getline(maps, line);)
    for (const char* name : {"libOSMesa", "libEGL", "libGL", "libgallium", "libLLVM", "swrast"})
      if (line.find(name) != std::string::npos) return line;
  return {};
}

}  // namespace

TEST_CASE("no OpenGL library is in the process until a renderer is created") {
  const test::Scene scene;
  CHECK(!bounds(scene.picture).isEmpty());
  CHECK(mapped_gl_library() == "");
  CHECK_THROWS_AS(Renderer(0, 480), std::invalid_argument);
  CHECK_THROWS_AS(Renderer(1 << 30, 480), std::invalid_argument);
  CHECK(mapped_gl_library() == "");
  Renderer renderer(16, 16);
  CHECK(mapped_gl_library() != "");
}

}  // namespace loading_test
