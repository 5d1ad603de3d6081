// Validation of a document against the records of a scene: unknown and missing keys, types, ranges and
// choices. All faults are reported at once.
#pragma once

#include <string>

#include <pliant/scene/diagnostics.h>
#include <pliant/scene/json/json_document.h>
#include <pliant/scene/schema/schema.h>

namespace pliant {

/// Validates the whole document; the key "$schema" is allowed at the root. Faults are added to `faults`. For
/// a key in the wrong place the message names the record to which the key belongs.
void validate(const JsonDocument& document, const schema::Record& root, Diagnostics& faults);

/// Validates one value of the document. Used for types that depend on other values, for example the
/// parameters of a shape.
void validate(const JsonDocument& document, const JsonValue& value, const schema::Type& type,
              Diagnostics& faults);

}  // namespace pliant
