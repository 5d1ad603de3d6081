// The records of drives of joints and parameters (body/actuation/drive.h).
#pragma once

#include <string>

#include <pliant/scene/schema/schema.h>

namespace pliant {

/// Returns the record of a drive on a coordinate of a joint. name: name of the record. unit: unit of the
/// coordinate, "m" or "rad". force: unit of the force along the coordinate.
schema::Record drive_record(std::string name, const std::string& unit, const std::string& force);
/// Returns the record of a drive on a parameter. Each of its units has variants for a length, an angle and a
/// dimensionless number.
schema::Record parameter_drive_record();
/// Returns the record of a drive of a ball joint, whose target has three components.
schema::Record ball_drive_record();

}  // namespace pliant
