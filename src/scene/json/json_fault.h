// What is wrong with a text that is not JSON, in words that say what to do.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace pliant::json {

/// A fault that leaves no value to go on with.
struct Fault {
  std::size_t offset;
  std::string pointer;
  std::string message;
};

/// What has been read last, and so what may follow.
enum class After { kNothing, kObjectStart, kKey, kMember, kArrayStart, kElement, kDocument };

/// How far reading came before it failed.
struct Progress {
  std::string_view text;
  std::size_t at;  ///< just behind the last good token
  After after;
  std::size_t opening;  ///< the innermost bracket that is open, if any
  bool open;
  std::function<std::string(std::size_t)> place;  ///< offset as words, "line 3, column 5"
};

/// The fault at which reading stopped (its pointer is left empty).
Fault explain(const Progress& progress);

/// A text that is no JSON from its first bytes on: empty, compressed, a picture, UTF-16. True when it is,
/// with the fault.
bool is_foreign(std::string_view text, Fault* fault);

}  // namespace pliant::json
