// OSMesa draws into memory and needs no display. OSMesa's header is not used, because it includes the old GL
// header. The renderer draws to its own framebuffer object, so the buffer that OSMesa requires is small.
#include <array>
#include <stdexcept>

#include "gl_platform.h"

namespace pliant {
namespace {

// Values and signatures of OSMesa's interface (stable since Mesa 11.2).
constexpr int kFormat = 0x22, kRgba = 0x1908, kDepthBits = 0x30, kStencilBits = 0x31, kAccumBits = 0x32,
              kProfile = 0x33, kCoreProfile = 0x34, kMajorVersion = 0x36, kMinorVersion = 0x37;
constexpr unsigned kUnsignedByte = 0x1401;
constexpr int kBufferSide = 16;
using Context = void*;
using CreateContextAttribs = Context (*)(const int*, Context);
using DestroyContext = void (*)(Context);
using MakeCurrent = unsigned char (*)(Context, void*, unsigned, int, int);
using GetProcAddress = void* (*)(const char*);

class OsmesaPlatform : public GlContext::Platform {
 public:
  OsmesaPlatform() {
    void* library = open_library({"libOSMesa.so.8", "libOSMesa.so.6"});
    const auto create =
        reinterpret_cast<CreateContextAttribs>(library_symbol(library, "OSMesaCreateContextAttribs"));
    destroy_ = reinterpret_cast<DestroyContext>(library_symbol(library, "OSMesaDestroyContext"));
    make_current_ = reinterpret_cast<MakeCurrent>(library_symbol(library, "OSMesaMakeCurrent"));
    get_proc_address_ = reinterpret_cast<GetProcAddress>(library_symbol(library, "OSMesaGetProcAddress"));
    const int attributes[] = {kFormat,  kRgba,        kDepthBits,    0, kStencilBits,  0, kAccumBits, 0,
                              kProfile, kCoreProfile, kMajorVersion, 3, kMinorVersion, 3, 0,          0};
    context_ = create(attributes, nullptr);
    if (!context_) throw std::runtime_error("OSMesa cannot create an OpenGL 3.3 core context");
  }
  ~OsmesaPlatform() override { destroy_(context_); }
  OsmesaPlatform(const OsmesaPlatform&) = delete;
  OsmesaPlatform& operator=(const OsmesaPlatform&) = delete;

  void make_current() override {
    if (!make_current_(context_, buffer_.data(), kUnsignedByte, kBufferSide, kBufferSide))
      throw std::runtime_error("OSMesa cannot make its context current");
  }
  void release() override { make_current_(nullptr, nullptr, 0, 0, 0); }
  void* function(const char* name) const override { return get_proc_address_(name); }

 private:
  DestroyContext destroy_ = nullptr;
  MakeCurrent make_current_ = nullptr;
  GetProcAddress get_proc_address_ = nullptr;
  Context context_ = nullptr;
  std::array<unsigned char, std::size_t{4} * kBufferSide * kBufferSide> buffer_{};
};

}  // namespace

std::unique_ptr<GlContext::Platform> open_osmesa() {
  return std::make_unique<OsmesaPlatform>();
}

}  // namespace pliant
