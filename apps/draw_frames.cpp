// Drawing the frames of a run. A graphics context is opened before drawing, so that a missing graphics
// library is reported with its own exit code.
#include "draw_frames.h"

#include <array>
#include <csignal>
#include <cstddef>
#include <stdexcept>

#include <unistd.h>

#include "exit_codes.h"
#include "failure.h"

namespace pliant_cli {
namespace {

/// Prints a message and ends the program with kResources, or with kFileSystem if the message cannot be
/// written. Calls only functions that a signal handler may call.
extern "C" void on_graphics_crash(int number) {
  const char segmentation[] = "pliant: error: the graphics library crashed (segmentation fault)",
             aborted[] = "pliant: error: the graphics library aborted",
             reason[] =
                 ", probably because it ran out of memory. Recorded motion is kept; pliant run --resume "
                 "continues a run\n";
  const auto print = [](const char* text, std::size_t size) { return ::write(STDERR_FILENO, text, size); };
  const bool printed = (number == SIGABRT ? print(aborted, sizeof aborted - 1)
                                          : print(segmentation, sizeof segmentation - 1)) > 0 &&
                       print(reason, sizeof reason - 1) > 0;
  ::_exit(printed ? kResources : kFileSystem);
}

/// While the object exists, crashes are reported as crashes of the graphics library. Libraries of OpenGL and
/// their compilers crash or abort if they cannot allocate memory.
class GraphicsCrashes {
 public:
#ifndef PLIANT_SANITIZED  // a sanitizer reports crashes itself
  GraphicsCrashes() {
    struct sigaction action {};
    action.sa_handler = on_graphics_crash;
    sigemptyset(&action.sa_mask);
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &action, &before_[i]);
  }
  ~GraphicsCrashes() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &before_[i], nullptr);
  }
#else
  GraphicsCrashes() {}
  ~GraphicsCrashes() {}
#endif
  GraphicsCrashes(const GraphicsCrashes&) = delete;
  GraphicsCrashes& operator=(const GraphicsCrashes&) = delete;

 private:
  static constexpr std::array<int, 3> kSignals{SIGSEGV, SIGBUS, SIGABRT};
#ifndef PLIANT_SANITIZED
  std::array<struct sigaction, kSignals.size()> before_{};
#endif
};

}  // namespace

std::string require_graphics(pliant::GlBackend backend) {
  const GraphicsCrashes reported;
  try {
    const pliant::GlContext probe(backend);
    return probe.backend() + ": " + probe.renderer() + ", OpenGL " + probe.version();
  } catch (const std::runtime_error& error) {
    throw ResourceFailure(error.what());
  }
}

void draw_frames(const std::filesystem::path& folder, const pliant::FilmSource& source, double frame_rate,
                 const std::vector<std::int64_t>& frames, pliant::Progress& progress,
                 pliant::GlBackend backend) {
  require_graphics(backend);
  const GraphicsCrashes reported;
  pliant::render_frames(folder, source, frame_rate, frames, progress, backend);
}

}  // namespace pliant_cli
