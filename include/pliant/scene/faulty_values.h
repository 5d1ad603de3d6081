// The values of a document at which, or inside which, a fault was found: the rest of the scene can still be
// read and judged, so that all faults are told at once.
#pragma once

#include <unordered_set>

#include <pliant/scene/diagnostics.h>
#include <pliant/scene/json/json_document.h>
#include <pliant/scene/json/json_value.h>

namespace pliant {

/// Addresses of values of a document; valid as long as the document is not changed.
using FaultyValues = std::unordered_set<const JsonValue*>;

/// Of the errors that are stored; the pointer of each says where it is.
FaultyValues faulty_values(const JsonDocument& document, const Diagnostics& faults);

}  // namespace pliant
