// Checks a document against the records of a scene: unknown and missing keys, types, ranges, choices, all
// faults at once.
#pragma once

#include <string>

#include <pliant/scene/diagnostics.h>
#include <pliant/scene/json/json_document.h>
#include <pliant/scene/schema/schema.h>

namespace pliant {

/// The whole document; "$schema" is allowed at the root. The keys of all records are known to the messages: a
/// key in the wrong place is told where it belongs.
void validate(const JsonDocument& document, const schema::Record& root, Diagnostics& faults);

/// One value of the document, for what a record alone cannot know (the parameters of a shape, say).
void validate(const JsonDocument& document, const JsonValue& value, const schema::Type& type,
              Diagnostics& faults);

}  // namespace pliant
