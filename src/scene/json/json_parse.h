// Parsing of JSON text with the event (SAX) parser of nlohmann-json. The events contain no offsets, but they
// come in the order of the text. A cursor that moves from token to token gives the offset of each token.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include <pliant/scene/json/json_value.h>

#include "json_fault.h"

namespace pliant::json {

struct ParseOptions {
  std::uint32_t source = 0;                       ///< JsonPlace::source of the values
  int depth = 0;                                  ///< nesting depth at which the value will be inserted
  std::function<std::string(std::size_t)> place;  ///< converts an offset to words, for messages
  std::function<void(const Fault&)> report;       ///< receives faults that do not end the parsing
};

/// Returns the value of a JSON text. Throws Fault if the text is not JSON, or if it exceeds the limit of
/// nesting or of the number of values.
JsonValue parse(std::string_view text, const ParseOptions& options);

}  // namespace pliant::json
