// libFuzzer target: any text is a scene, or is refused with a SceneError that lists an error, or describes
// joints that cannot close. Scenes of more than a kilobyte, or with exponents ("eps"), are not built, because
// their mass points may take seconds; their text is parsed and validated.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <pliant/scene/read_scene.h>
#include <pliant/scene/schema/scene_schema.h>
#include <pliant/scene/validate.h>
#include <pliant/simulate/simulation.h>

namespace {

constexpr std::size_t kLargestBuilt = 1024;

void read(const std::string& text, pliant::Diagnostics& faults) {
  if (text.size() <= kLargestBuilt && text.find("eps") == std::string::npos) {
    pliant::parse_scene("s.json", text, {}, faults);
    return;
  }
  const pliant::JsonDocument document = pliant::JsonDocument::parse("s.json", text, faults);
  pliant::validate(document, pliant::scene_record(), faults);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pliant::Diagnostics faults;
  try {
    read(std::string(reinterpret_cast<const char*>(data), size), faults);
  } catch (const pliant::SceneError& error) {
    if (error.diagnostics().errors() == 0) {
      std::fprintf(stderr, "a scene is refused without an error\n");
      std::abort();
    }
  } catch (const pliant::UnsatisfiableModel&) {
    return 0;
  }
  return 0;
}
