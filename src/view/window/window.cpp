// The window: GLFW for its context and inputs, Dear ImGui for its panel, and the loop of its pictures.
#include <algorithm>
#include <cmath>
#include <optional>
#include <ostream>
#include <string>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <pliant/view/viewer.h>

#include "live_motion.h"
#include "recorded_motion.h"
#include "script.h"
#include "viewer.h"

namespace pliant {
namespace {

// Times between pictures, s of wall time: of a motion, of a simulation that is later than kLate, and of a
// still picture.
constexpr double kFrame = 1.0 / 60, kLateFrame = 1.0 / 25, kIdle = 0.1;
constexpr double kLate = 0.02;

[[noreturn]] void fail(const std::string& what) {
  const char* reason = nullptr;
  glfwGetError(&reason);
  throw NoWindow(what + (reason != nullptr ? std::string(": ") + reason : ""));
}

/// GLFW, and a window with an OpenGL 3.3 core context that is current on this thread.
class GlfwWindow {
 public:
  GlfwWindow(int width, int height, const std::string& title) {
    if (!glfwInit()) fail("GLFW cannot open a display");
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (window_ == nullptr) {
      try {
        fail("GLFW cannot open a window with OpenGL 3.3");
      } catch (...) {
        glfwTerminate();
        throw;
      }
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(0);  // the loop limits the pictures per second
  }
  ~GlfwWindow() {
    glfwDestroyWindow(window_);
    glfwTerminate();
  }
  GlfwWindow(const GlfwWindow&) = delete;
  GlfwWindow& operator=(const GlfwWindow&) = delete;
  GLFWwindow* get() const { return window_; }

 private:
  GLFWwindow* window_ = nullptr;
};

Viewer& viewer_of(GLFWwindow* window) {
  return *static_cast<Viewer*>(glfwGetWindowUserPointer(window));
}

std::optional<MouseButton> button_of(int button) {
  if (button == GLFW_MOUSE_BUTTON_LEFT) return MouseButton::left;
  if (button == GLFW_MOUSE_BUTTON_RIGHT) return MouseButton::right;
  if (button == GLFW_MOUSE_BUTTON_MIDDLE) return MouseButton::middle;
  return {};
}

/// Connects the inputs of a window with a viewer. Inputs on the panel do not reach the viewer.
void connect(GLFWwindow* window, Viewer& viewer) {
  glfwSetWindowUserPointer(window, &viewer);
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
    int wide = 1, high = 1;
    glfwGetWindowSize(w, &wide, &high);
    Viewer& v = viewer_of(w);
    v.mouse_moved(x * v.width() / std::max(1, wide), y * v.height() / std::max(1, high));
  });
  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int number, int action, int mods) {
    const std::optional<MouseButton> button = button_of(number);
    if (!button) return;
    if (action == GLFW_RELEASE)
      viewer_of(w).mouse_released(*button);
    else if (!ImGui::GetIO().WantCaptureMouse)
      viewer_of(w).mouse_pressed(*button, (mods & GLFW_MOD_SHIFT) != 0);
  });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double y) {
    if (!ImGui::GetIO().WantCaptureMouse) viewer_of(w).wheel_turned(y);
  });
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
    if (action == GLFW_RELEASE || ImGui::GetIO().WantCaptureKeyboard) return;
    if (key == GLFW_KEY_SPACE) viewer_of(w).key_pressed("space");
    if (key >= GLFW_KEY_A && key <= GLFW_KEY_Z)
      viewer_of(w).key_pressed(std::string(1, static_cast<char>('a' + key - GLFW_KEY_A)));
    if (key == GLFW_KEY_ESCAPE) glfwSetWindowShouldClose(w, GLFW_TRUE);
  });
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int wide, int high) {
    if (wide > 0 && high > 0) viewer_of(w).resized(wide, high);
  });
  int wide = 0, high = 0;
  glfwGetFramebufferSize(window, &wide, &high);
  viewer.resized(wide, high);
}

/// Dear ImGui with its renderer. Its callbacks also call the callbacks that connect() has set.
class Panel {
 public:
  explicit Panel(GLFWwindow* window) {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui::StyleColorsLight();
    ImGui::GetStyle().WindowRounding = 4;
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
  }
  ~Panel() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  Panel(const Panel&) = delete;
  Panel& operator=(const Panel&) = delete;

  void draw(Viewer& viewer) {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    viewer.add_panel();
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  }
};

/// Handles inputs until the time of the next picture. If nothing changes, returns after the first input.
void handle_inputs(const Viewer& viewer, WallClock::time_point started) {
  const bool is_idle = viewer.is_idle();
  const double motion_frame = viewer.motion().delay() > kLate ? kLateFrame : kFrame;
  const double frame = is_idle ? kIdle : motion_frame;
  double left = frame - seconds_since(started);
  if (left <= 0) return glfwPollEvents();
  do {
    glfwWaitEventsTimeout(left);
    left = frame - seconds_since(started);
  } while (!is_idle && left > 0);
}

/// Draws pictures until the window is closed, the script has ended or the time of the bench is over.
void draw_pictures(GLFWwindow* window, Viewer& viewer, const ViewOptions& options, std::ostream& out) {
  Panel panel(window);
  std::optional<Script> script;
  if (!options.script.empty()) script.emplace(options.script);
  const WallClock::time_point start = WallClock::now();
  const double start_time = viewer.motion().time();
  std::int64_t pictures = 0;
  while (!glfwWindowShouldClose(window)) {
    const WallClock::time_point started = WallClock::now();
    if (script && !script->perform(viewer, out)) break;
    if (options.bench > 0 && seconds_since(start) >= options.bench) break;
    const bool is_new = viewer.draw();
    panel.draw(viewer);
    glfwSwapBuffers(window);
    if (is_new) {
      ++pictures;
      viewer.add_picture_time(seconds_since(started));
    }
    handle_inputs(viewer, started);
  }
  if (!(options.bench > 0)) return;
  const double wall = seconds_since(start);
  out << viewer.renderer().device() << ", " << viewer.width() << " x " << viewer.height() << ": "
      << static_cast<double>(pictures) / wall << " pictures per second with "
      << std::pow(WindowRenderer::samples(viewer.draft()), 2)
      << " samples per pixel; simulated time / wall time " << (viewer.motion().time() - start_time) / wall
      << "\n";
  viewer.motion().report(out);
}

void show(Motion& motion, const std::string& title, const ViewOptions& options, std::ostream& out) {
  const GlfwWindow window(options.width, options.height, title);
  Viewer viewer(motion, [](const char* name) { return reinterpret_cast<void*>(glfwGetProcAddress(name)); });
  connect(window.get(), viewer);
  if (options.plays || options.bench > 0) motion.play(true);
  draw_pictures(window.get(), viewer, options, out);
}

}  // namespace

std::string missing_window_packages() {
  return "";
}

void view_scene(Scene& scene, const ViewOptions& options, std::ostream& out) {
  LiveMotion motion(scene, options);
  show(motion, "pliant: " + scene.name, options, out);
}

void view_recording(Scene& scene, const Model& model, const Recording& recording, const ViewOptions& options,
                    std::ostream& out) {
  RecordedMotion motion(scene, model, recording);
  show(motion, "pliant: recording of " + scene.name, options, out);
}

}  // namespace pliant
