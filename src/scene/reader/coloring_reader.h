// Reading the colouring of parts by their deformation.
#pragma once

#include <map>
#include <string>

#include <pliant/scene/coloring.h>
#include <pliant/scene/reader/reader.h>
#include <pliant/scene/schema/schema.h>

#include "point_reader.h"
#include "scene/scene_faults.h"

namespace pliant {

schema::Record coloring_record();

/// Returns the colouring of a scene. coloring: a reader of an object that was validated against
/// coloring_record(), with Reader::complete() true. parts: the parts by name. Unknown part names are
/// reported.
Coloring read_coloring(const Reader& coloring, const std::map<std::string, NamedPart>& parts,
                       SceneFaults& faults);

}  // namespace pliant
