// EGL without a window or a surface: on Mesa's surfaceless platform, or on its software device. GlContext
// tries the software device last, because it needs two more extensions. Displays are shared by the whole
// process and are therefore never terminated.
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>

#include "gl_platform.h"

namespace pliant {
namespace {

// Values and signatures of EGL 1.5, EXT_platform_device and MESA_platform_surfaceless.
constexpr unsigned kOpenGlApi = 0x30A2, kSurfaceless = 0x31DD, kDevice = 0x313F;
constexpr int kExtensions = 0x3055, kMajorVersion = 0x3098, kMinorVersion = 0x30FB, kProfileMask = 0x30FD,
              kCoreProfile = 1, kNone = 0x3038;
using Display = void*;
using Context = void*;
using Device = void*;
using GetProcAddress = void* (*)(const char*);
using GetError = int (*)();
using Initialize = unsigned (*)(Display, int*, int*);
using BindApi = unsigned (*)(unsigned);
using CreateContext = Context (*)(Display, void*, Context, const int*);
using DestroyContext = unsigned (*)(Display, Context);
using MakeCurrent = unsigned (*)(Display, void*, void*, Context);
using GetPlatformDisplay = Display (*)(unsigned, void*, const std::intptr_t*);
using QueryDevices = unsigned (*)(int, Device*, int*);
using QueryDeviceString = const char* (*)(Device, int);

class EglPlatform : public GlContext::Platform {
 public:
  explicit EglPlatform(unsigned kind) {
    void* library = open_library({"libEGL.so.1"});
    get_proc_address_ = reinterpret_cast<GetProcAddress>(library_symbol(library, "eglGetProcAddress"));
    get_error_ = entry<GetError>("eglGetError");
    bind_api_ = entry<BindApi>("eglBindAPI");
    make_current_ = entry<MakeCurrent>("eglMakeCurrent");
    destroy_ = entry<DestroyContext>("eglDestroyContext");

    display_ = entry<GetPlatformDisplay>("eglGetPlatformDisplay")(
        kind, kind == kDevice ? software_device() : nullptr, nullptr);
    if (!display_) fail("eglGetPlatformDisplay returned no display");
    if (!entry<Initialize>("eglInitialize")(display_, nullptr, nullptr)) fail("eglInitialize failed");
    if (!bind_api_(kOpenGlApi)) fail("EGL has no desktop OpenGL");
    const int attributes[] = {kMajorVersion, 3, kMinorVersion, 3, kProfileMask, kCoreProfile, kNone};
    context_ = entry<CreateContext>("eglCreateContext")(display_, nullptr, nullptr, attributes);
    if (!context_) fail("EGL cannot create an OpenGL 3.3 core context");
  }
  ~EglPlatform() override { destroy_(display_, context_); }
  EglPlatform(const EglPlatform&) = delete;
  EglPlatform& operator=(const EglPlatform&) = delete;

  void make_current() override {
    bind_api_(kOpenGlApi);
    if (!make_current_(display_, nullptr, nullptr, context_)) fail("EGL cannot make its context current");
  }
  void release() override { make_current_(display_, nullptr, nullptr, nullptr); }
  void* function(const char* name) const override { return get_proc_address_(name); }

 private:
  template <class F>
  F entry(const char* name) const {
    void* address = get_proc_address_(name);
    if (!address) throw std::runtime_error(std::string("EGL has no function ") + name);
    return reinterpret_cast<F>(address);
  }

  [[noreturn]] void fail(const char* reason) const {
    char code[32];
    std::snprintf(code, sizeof code, " (EGL error 0x%04x)", static_cast<unsigned>(get_error_()));
    throw std::runtime_error(std::string(reason) + code);
  }

  Device software_device() const {
    std::array<Device, 32> devices{};
    int count = 0;
    entry<QueryDevices>("eglQueryDevicesEXT")(static_cast<int>(devices.size()), devices.data(), &count);
    const auto query = entry<QueryDeviceString>("eglQueryDeviceStringEXT");
    for (int i = 0; i < count; ++i) {
      const char* extensions = query(devices[i], kExtensions);
      if (extensions && std::strstr(extensions, "EGL_MESA_device_software")) return devices[i];
    }
    throw std::runtime_error("EGL has no software device");
  }

  GetProcAddress get_proc_address_ = nullptr;
  GetError get_error_ = nullptr;
  BindApi bind_api_ = nullptr;
  MakeCurrent make_current_ = nullptr;
  DestroyContext destroy_ = nullptr;
  Display display_ = nullptr;
  Context context_ = nullptr;
};

}  // namespace

std::unique_ptr<GlContext::Platform> open_egl_surfaceless() {
  return std::make_unique<EglPlatform>(kSurfaceless);
}
std::unique_ptr<GlContext::Platform> open_egl_software_device() {
  return std::make_unique<EglPlatform>(kDevice);
}

}  // namespace pliant
