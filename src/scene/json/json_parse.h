// From text to values, through nlohmann-json's event parser. Its events carry no places: since it reports
// tokens in the order of the text and only after checking them, a cursor that skips from token to token knows
// the place of each.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include <pliant/scene/json/json_value.h>

#include "json_fault.h"

namespace pliant::json {

struct ParseOptions {
  std::uint32_t source = 0;                       ///< goes into the places
  int depth = 0;                                  ///< nesting around the text
  std::function<std::string(std::size_t)> place;  ///< an offset in words, for messages
  std::function<void(const Fault&)> report;       ///< faults after which reading goes on
};

/// Throws Fault when the text has no value.
JsonValue parse(std::string_view text, const ParseOptions& options);

}  // namespace pliant::json
