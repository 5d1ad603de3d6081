// pliant doctor: reports which features work on this machine.
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include <pliant/io/format/whole_file.h>
#include <pliant/io/run/wall_clock.h>
#include <pliant/render/gl/gl_context.h>
#include <pliant/view/viewer.h>

#include "command.h"
#include "exit_codes.h"
#include "machine.h"

namespace pliant_cli {
namespace {

namespace fs = std::filesystem;

void print_graphics() {
  bool any_opened = false;
  std::cout << "graphics\n";
  for (const pliant::GlProbe& probe : pliant::probe_gl_backends()) {
    std::cout << "  " << probe.name << ": ";
    if (probe.opened)
      std::cout << "works: " << probe.renderer << ", OpenGL " << probe.version << "\n";
    else
      std::cout << "does not open: " << probe.reason << "\n";
    any_opened = any_opened || probe.opened;
  }
  if (!any_opened)
    std::cout << "  pictures (--png, render) need libosmesa6, or libegl1 with libgl1-mesa-dri: install one "
                 "of them\n";
}

void print_window() {
  const std::string missing = pliant::missing_window_packages();
  std::cout << "window\n  pliant view: "
            << (missing.empty() ? std::string("built in")
                                : "not built in; install " + missing + ", configure again and build")
            << "\n";
}

// Writes a temporary file of 64 MiB to a folder and waits until its bytes are on the disk. Returns the speed,
// MB/s.
double write_speed(const fs::path& folder) {
  constexpr std::size_t block = std::size_t{1} << 20, blocks = 64;
  const std::vector<char> bytes(block, 'p');
  const fs::path file = folder / ("pliant-doctor-" + std::to_string(::getpid()));
  const pliant::WallClock::time_point start = pliant::WallClock::now();
  {
    pliant::WholeFile writer(file);
    for (std::size_t i = 0; i < blocks; ++i) writer.write(bytes.data(), bytes.size());
    writer.become_target(pliant::Durable::yes);
  }
  const double seconds = pliant::seconds_since(start);
  fs::remove(file);
  return static_cast<double>(block * blocks) / 1e6 / seconds;
}

int examine(const fs::path& folder) {
  std::cout << version_text();
  const std::string features = processor_features();
  std::cout << "processor\n  " << std::thread::hardware_concurrency()
            << " threads; features: " << (features.empty() ? "unknown" : features)
            << "\n  BLAS loaded: " << loaded_blas() << "\n";
  print_graphics();
  print_window();
  const std::string ffmpeg = find_program("ffmpeg");
  std::cout << "films\n  ffmpeg: "
            << (ffmpeg.empty() ? "not installed (needed only to make films from frames)" : ffmpeg) << "\n";
  std::cout << "output folder " << folder.string() << "\n" << std::flush;
  const fs::space_info space = fs::space(folder);
  std::cout << "  writes " << static_cast<long>(write_speed(folder)) << " MB/s, " << space.available / 1000000
            << " MB free\n";
  return kDone;
}

}  // namespace

void add_doctor(CLI::App& app, Action& action) {
  const auto folder = std::make_shared<std::string>(".");
  CLI::App* command = app.add_subcommand(
      "doctor", "Report the state of this machine: graphics libraries, processor, ffmpeg, speed of the disk");
  command->add_option("-o,--out", *folder, "Folder for the measurement of the disk speed [.]")
      ->check(CLI::ExistingDirectory)
      ->option_text("DIR");
  command->callback([folder, &action] { action = [folder] { return examine(*folder); }; });
}

}  // namespace pliant_cli
