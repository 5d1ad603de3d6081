#include "drive_reader.h"

#include <array>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <pliant/body/actuation/joint_coordinate.h>
#include <pliant/body/joints/ball.h>

#include "direction_reader.h"

namespace pliant {

namespace {

/// Reads the function under a key, if the key is given.
bool read(const Reader& r, const char* key, const StateReader& states, StateFunction& function) {
  if (r.faulty(key)) return false;
  if (!r.given(key)) return true;
  const std::optional<StateFunction> read = states.function(r.at(key));
  if (read) function = *read;
  return read.has_value();
}

/// Reads the stiffness, damping, force and bound of a drive.
bool read_gains(const Reader& r, const StateReader& states, Drive& drive) {
  const bool stiffness = read(r, "stiffness", states, drive.stiffness);
  const bool damping = read(r, "damping", states, drive.damping);
  const bool force = read(r, "force", states, drive.force);
  if (r.given("max_force")) drive.max_force = r.number("max_force");
  return stiffness && damping && force && !r.faulty("max_force");
}

}  // namespace

bool read_drive(const Reader& r, const StateReader& states, Drive& drive) {
  const bool gains = read_gains(r, states, drive), target = read(r, "target", states, drive.target);
  if (!r.given("rate")) return gains && target && !r.faulty("rate");
  drive.target_rate.emplace();
  return read(r, "rate", states, *drive.target_rate) && gains && target;
}

void check_sum_of_stiffnesses(const Reader& parameter, const Drive& drive, SceneFaults& faults) {
  const double own = parameter.given("stiffness") ? parameter.number("stiffness") : 0;
  if (!drive.stiffness.is_constant() || own + drive.stiffness.constant() >= 0) return;
  std::ostringstream message;
  message << "the sum with the stiffness of the parameter, " << own << ", is negative; expected at least "
          << 0 - own;
  faults.value(parameter.object("drive").at("stiffness"), message.str());
}

void read_joint_limits(const Reader& r, const Joint& joint, SceneFaults& faults, MultiBody& body) {
  auto add = [&](const char* key, auto&& limit) {
    if (!r.given(key)) return;
    try {
      limit();
    } catch (const std::invalid_argument& fault) {
      faults.place(r.at(key), fault.what());
    }
  };
  if (r.name() == Ball::name) {
    if (r.given("axis") || r.given("rotation")) {
      BallAxes axes;
      axes.axis = read_direction(r.at("axis"), faults);
      if (r.given("rotation")) axes.rotation = read_orientation(r.object("rotation"), faults);
      body.coordinate(joint, axes);
    }
    add("max_swing", [&] { body.limit_swing(joint, r.number("max_swing"), r.number("restitution")); });
    add("twist_limits", [&] {
      const std::vector<double> range = r.numbers("twist_limits");
      body.limit_twist(joint, range[0], range[1], r.number("restitution"));
    });
  } else if (coordinate_rows(r.name()) > 0) {
    add("limits", [&] {
      const std::vector<double> range = r.numbers("limits");
      body.limit(joint, range[0], range[1], r.number("restitution"));
    });
  }
}

void read_joint_drive(const Reader& r, const Joint& joint, const StateReader& states, MultiBody& body) {
  const Joint& coordinate = body.coordinate(joint);
  if (coordinate.rows() == 1) {
    read_drive(r, states, body.drive(joint.name(), coordinate));
    return;
  }
  const std::optional<StateVector> target = states.vector(r, "target"), rate = states.vector(r, "rate");
  static constexpr std::array<const char*, 3> rows{".twist", ".swing_y", ".swing_z"};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    Drive& drive = body.drive(joint.name() + rows[k], coordinate, static_cast<int>(k));
    read_gains(r, states, drive);
    if (target) drive.target = target->component[k];
    if (rate) drive.target_rate = rate->component[k];
  }
}

}  // namespace pliant
