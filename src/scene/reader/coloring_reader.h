// Reading how parts are coloured in pictures.
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

/// coloring: an object of the record above that is complete. parts: by name.
Coloring read_coloring(const Reader& coloring, const std::map<std::string, NamedPart>& parts,
                       SceneFaults& faults);

}  // namespace pliant
