// Messages for a text that is not valid JSON. A message names the fault and its correction.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace pliant::json {

/// A fault of the text.
struct Fault {
  std::size_t offset;   ///< byte offset in the text
  std::string pointer;  ///< JSON pointer of the value, or empty for a fault of syntax
  std::string message;
};

/// The last item that the parser read; it determines which tokens may follow.
enum class After { kNothing, kObjectStart, kKey, kMember, kArrayStart, kElement, kDocument };

/// The state of the parser when it failed.
struct Progress {
  std::string_view text;
  std::size_t at;  ///< offset just after the last good token
  After after;
  std::size_t opening;  ///< offset of the innermost open bracket, if `open`
  bool open;
  std::function<std::string(std::size_t)> place;  ///< converts an offset to words, "line 3, column 5"
};

/// Returns the fault at which the parser stopped. Its JSON Pointer is empty.
Fault explain(const Progress& progress);

/// Returns whether a text is empty or begins like another format (for example gzip, PNG, XML or UTF-16). If
/// so, stores the fault in *fault.
bool is_foreign(std::string_view text, Fault* fault);

}  // namespace pliant::json
