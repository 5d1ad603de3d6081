// The viewer of a build without GLFW or Dear ImGui.
#include <pliant/view/viewer.h>

namespace pliant {
namespace {

[[noreturn]] void fail() {
  throw NoWindow("this build has no window; install " + missing_window_packages() +
                 " (Debian names), configure again and build");
}

}  // namespace

std::string missing_window_packages() {
  return PLIANT_MISSING_WINDOW_PACKAGES;
}

void view_scene(Scene&, const ViewOptions&, std::ostream&) {
  fail();
}

void view_recording(Scene&, const Model&, const Recording&, const ViewOptions&, std::ostream&) {
  fail();
}

}  // namespace pliant
