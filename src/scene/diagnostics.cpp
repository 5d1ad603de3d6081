#include <pliant/scene/diagnostics.h>

#include <algorithm>
#include <cstdio>
#include <tuple>

#include "scene/json/json_write.h"
#include "scene/json/utf8.h"

namespace pliant {

namespace {

/// Returns whether a character is a control character, a line or paragraph separator, a byte-order mark, or a
/// mark that changes the writing direction.
bool is_unsafe(char32_t c) {
  return c < 0x20 || (c >= 0x7F && c <= 0x9F) || c == 0x200E || c == 0x200F || (c >= 0x2028 && c <= 0x202E) ||
         (c >= 0x2066 && c <= 0x2069) || c == 0xFEFF;
}

std::string escape(char32_t c) {
  if (c == '\n') return "\\n";
  if (c == '\r') return "\\r";
  if (c == '\t') return "\\t";
  char text[16];
  std::snprintf(text, sizeof text, c < 0x80 ? "\\x%02x" : "\\u{%x}", static_cast<unsigned>(c));
  return text;
}

const char* name(Severity severity) {
  return severity == Severity::kError ? "error" : "warning";
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t n = utf8::length(text, i);
    if (n == 0) {
      char byte[8];
      std::snprintf(byte, sizeof byte, "\\x%02x", static_cast<unsigned>(static_cast<unsigned char>(text[i])));
      result += byte;
      ++i;
      continue;
    }
    const char32_t c = utf8::decode(text, i);
    if (is_unsafe(c)) {
      result += escape(c);
    } else {
      result += text.substr(i, n);
    }
    i += n;
  }
  return result;
}

std::string to_string(const Diagnostic& d) {
  std::string line = escaped(d.file);
  if (d.line > 0) line += ":" + std::to_string(d.line) + ":" + std::to_string(d.column);
  line += std::string(": ") + name(d.severity) + ": ";
  if (!d.pointer.empty()) line += escaped(d.pointer) + ": ";
  return line + escaped(d.message);
}

void Diagnostics::add(Diagnostic diagnostic) {
  ++(diagnostic.severity == Severity::kError ? errors_ : warnings_);
  if (!full()) stored_.push_back(std::move(diagnostic));
}

std::vector<Diagnostic> Diagnostics::sorted() const {
  std::vector<std::string> files;
  for (const Diagnostic& d : stored_) {
    if (std::find(files.begin(), files.end(), d.file) == files.end()) files.push_back(d.file);
  }
  const auto place = [&](const Diagnostic& d) {
    return std::make_tuple(std::find(files.begin(), files.end(), d.file) - files.begin(), d.line, d.column);
  };
  std::vector<Diagnostic> all = stored_;
  std::stable_sort(all.begin(), all.end(),
                   [&](const Diagnostic& a, const Diagnostic& b) { return place(a) < place(b); });
  return all;
}

std::string Diagnostics::text(std::size_t max_lines) const {
  std::string lines;
  const std::vector<Diagnostic> all = sorted();
  const std::size_t printed = std::min(max_lines, all.size());
  for (std::size_t i = 0; i < printed; ++i) lines += to_string(all[i]) + "\n";
  const std::size_t more = errors_ + warnings_ - printed;
  if (more > 0) lines += "... and " + std::to_string(more) + " more\n";
  return lines;
}

std::string Diagnostics::json() const {
  std::string out = "{\"errors\": " + std::to_string(errors_) +
                    ", \"warnings\": " + std::to_string(warnings_) + ", \"diagnostics\": [";
  bool first = true;
  for (const Diagnostic& d : sorted()) {
    out += first ? "\n" : ",\n";
    first = false;
    out += "  {\"file\": " + json_string(d.file) + ", \"line\": " + std::to_string(d.line) +
           ", \"column\": " + std::to_string(d.column) + ", \"pointer\": " + json_string(d.pointer) +
           ", \"severity\": \"" + name(d.severity) + "\", \"message\": " + json_string(d.message) + "}";
  }
  return out + (first ? "]}\n" : "\n]}\n");
}

void Diagnostics::throw_if_errors() const {
  if (errors_ > 0) throw SceneError(*this);
}

SceneError::SceneError(Diagnostics diagnostics)
    : std::runtime_error(diagnostics.text()), diagnostics_(std::move(diagnostics)) {}

}  // namespace pliant
