#include "scene_faults.h"

#include <cstdio>
#include <cstdlib>

#include <pliant/math/nearest_name.h>

#include "scene/json/json_write.h"

namespace pliant {

void SceneFaults::add(const JsonValue& at, std::string message, Severity severity) {
  // When the storage of the diagnostics is full, a fault is only counted, and its place is not searched for.
  diagnostics_.add(diagnostics_.full() ? Diagnostic{"", 0, 0, "", "", severity}
                                       : document_.fault(at, std::move(message), severity));
}

void SceneFaults::value(const JsonValue& at, const std::string& message) {
  add(at, document_.shown(at) + "; " + message, Severity::kError);
}

void SceneFaults::in_string(const JsonValue& string, std::size_t byte, const std::string& message) {
  diagnostics_.add(diagnostics_.full()
                       ? Diagnostic{}
                       : document_.fault_in_string(string, byte, document_.shown(string) + "; " + message));
}

void SceneFaults::warn(const JsonValue& at, const std::string& message) {
  add(at, document_.shown(at) + "; " + message, Severity::kWarning);
}

void SceneFaults::place(const JsonValue& at, const std::string& message) {
  add(at, message, Severity::kError);
}

void SceneFaults::key(const JsonValue& object, const std::string& key, const std::string& message) {
  diagnostics_.add(diagnostics_.full() ? Diagnostic{} : document_.fault_at_key(object, key, message));
}

void SceneFaults::twice(const JsonValue& first, const JsonValue& again) {
  const Diagnostic place = document_.fault(first, "");
  const std::string where =
      place.line > 0 ? "at line " + std::to_string(place.line) + ", column " + std::to_string(place.column)
                     : "from " + place.file;
  value(again, "name given twice; the first is " + where);
}

void SceneFaults::unknown(const JsonValue& name, const std::string& kind,
                          const std::vector<std::string>& names) {
  const std::string hint = diagnostics_.full() ? std::string()  // the message is counted, but not stored
                           : names.empty()     ? "; the scene has no " + kind + "s"
                                               : name_hint(name.string(), names);
  value(name, "unknown " + kind + hint);
}

std::string brief(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return shortest(std::strtod(text, nullptr));
}

std::string name_hint(std::string_view word, const std::vector<std::string>& names) {
  const std::string near = did_you_mean(word, names);
  if (!near.empty()) return near;
  constexpr std::size_t kMaxListed = 32;
  std::string list;
  for (std::size_t i = 0; i < names.size() && i < kMaxListed; ++i)
    list += (i == 0 ? "; expected one of \"" : ", \"") + names[i] + "\"";
  return names.size() > kMaxListed ? list + ", ..." : list;
}

}  // namespace pliant
