// Signals by their names, and formulas of the state from their text. The names of quantities are
//   part    x, y, z, vx, vy, vz, omega.x, omega.y, omega.z, PARAMETER, PARAMETER_dot (dynamic parameters)
//   joint   hinge: angle, rate; slider: position, rate; rod and string: length, rate;
//           ball: twist, swing_y, swing_z, twist_rate, swing_y_rate, swing_z_rate
//   spring  length, rate
//   point   x, y, z, vx, vy, vz
// A sensor or an input has no quantities: its name alone denotes its value.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <pliant/body/actuation/state_function.h>

namespace pliant {

class MultiBody;

/// Material points by their names.
using NamedPoints = std::map<std::string, Point>;

/// Returns the signal of a quantity of an owner, or std::nullopt if no object has the name `owner`. Adds the
/// coordinate of a joint to the body if the signal needs it. Throws std::invalid_argument if the owner does
/// not have the quantity, or if two objects of this name, for example a part and a spring, both have it.
std::optional<Signal> named_signal(MultiBody& body, const std::string& owner, const std::string& quantity,
                                   const NamedPoints& points = {});

/// Returns the function of a formula of t and of named quantities, for example "-20 * ball.z". Throws
/// FormulaError (math/formula.h) for an error in the text or an unknown name, and std::invalid_argument for
/// more than kMaxSignals quantities. at_points: the names of quantities_at_points(), for formulas of
/// distributed forces. Throws FormulaError if the formula reads a quantity at points whose name is also the
/// name of a sensor or input.
StateFunction state_formula(MultiBody& body, const std::string& text, const NamedPoints& points = {},
                            const std::vector<std::string>& at_points = {});

}  // namespace pliant
