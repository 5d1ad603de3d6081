#include <pliant/scene/faulty_values.h>

#include <string_view>

namespace pliant {

FaultyValues faulty_values(const JsonDocument& document, const Diagnostics& faults) {
  FaultyValues values;
  for (const Diagnostic& d : faults.sorted()) {
    if (d.severity != Severity::kError) continue;
    const std::string_view pointer = d.pointer;
    for (std::size_t end = 0;; end = pointer.find('/', end + 1)) {
      const JsonValue* value = document.at(pointer.substr(0, end));
      if (value == nullptr) break;
      values.insert(value);
      if (end == std::string_view::npos) break;
    }
  }
  return values;
}

}  // namespace pliant
