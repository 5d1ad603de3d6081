// Reading what touches what.
#pragma once

#include <map>
#include <string>

#include <pliant/body/multibody.h>
#include <pliant/scene/reader.h>
#include <pliant/scene/schema.h>

#include "point_reader.h"
#include "scene_faults.h"
#include "time_reader.h"

namespace pliant {

schema::Record contact_record();

/// contact: an object of the record above. parts: by name.
void read_contact(const Reader& contact, const std::map<std::string, NamedPart>& parts,
                  const TimeReader& times, SceneFaults& faults, MultiBody& body);

}  // namespace pliant
