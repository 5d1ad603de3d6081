// Reading the contact settings of a scene: planes, obstacles, groups and pairs.
#pragma once

#include <map>
#include <string>

#include <pliant/scene/reader/reader.h>
#include <pliant/scene/scene.h>
#include <pliant/scene/schema/schema.h>

#include "obstacle_reader.h"
#include "point_reader.h"
#include "scene/scene_faults.h"
#include "time_reader.h"

namespace pliant {

schema::Record contact_record(const schema::Type& orientation, const schema::Type& color);

/// Reads the contact settings into the scene. contact: an object of contact_record(). parts: the parts by
/// name. folder: the folder of the mesh files.
void read_contact(const Reader& contact, const std::map<std::string, NamedPart>& parts,
                  const TimeReader& times, const MeshFolder& folder, SceneFaults& faults, Scene& scene);

}  // namespace pliant
