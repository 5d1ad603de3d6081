// The set of values of a document that are faulty or contain a faulty value. The readers skip these values
// and check the rest of the scene, so that all faults are reported at once.
#pragma once

#include <unordered_set>

#include <pliant/scene/diagnostics.h>
#include <pliant/scene/json/json_document.h>
#include <pliant/scene/json/json_value.h>

namespace pliant {

/// Addresses of values of a document; valid until the document changes.
using FaultyValues = std::unordered_set<const JsonValue*>;

/// Returns the faulty values of the stored errors: the value at the pointer of each error and all values that
/// enclose it.
FaultyValues faulty_values(const JsonDocument& document, const Diagnostics& faults);

}  // namespace pliant
