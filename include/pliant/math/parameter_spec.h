// The description of one parameter of a shape or of a deformation: name, default, ranges, unit, meaning.
#pragma once

#include <limits>

namespace pliant {

/// The closed interval from min to max.
struct Range {
  double min, max;
  constexpr bool contains(double x) const { return x >= min && x <= max; }
};

/// How the displacement of a material point, caused by a change of the parameter, depends on the rest
/// position of the point. The quadrature of the mass is chosen accordingly (include/pliant/part/README.md).
enum class Follows {
  affine,   ///< affine in the rest position (x, y, z)
  section,  ///< affine in (x, y) within each section z = const of the rest shape
  ring,     ///< affine in (x, y) along each curve on which the material coordinates u and w are constant
  free,     ///< none of the above
};

/// The physical quantity of a parameter.
enum class Quantity {
  length,    ///< m; scales with the size of the part
  angle,     ///< rad
  exponent,  ///< squareness of a superquadric
  ratio,     ///< any other number without a unit
};

/// The description of one parameter.
struct ParameterSpec {
  const char* name;
  double standard;  ///< default value
  Range frozen;     ///< admissible values of a constant parameter
  Range dynamic;    ///< admissible values of a degree of freedom; each end is a one-sided constraint
  bool relative;    ///< whether the dynamic range is in multiples of the rest value
  Quantity quantity;
  const char* meaning;
  Follows follows;

  /// Returns the unit as text: "m", "rad" or "1".
  constexpr const char* unit() const {
    return quantity == Quantity::length ? "m" : quantity == Quantity::angle ? "rad" : "1";
  }
};

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Returns the description of a positive length (m). If the length is a degree of freedom, its range is 1e-3
/// to 1e3 times the rest value.
constexpr ParameterSpec length(const char* name, double standard, const char* meaning,
                               Follows follows = Follows::affine) {
  return {name, standard, {1e-12, 1e12}, {1e-3, 1e3}, true, Quantity::length, meaning, follows};
}

/// Returns the description of a displacement (m): a length of either sign, zero by default.
constexpr ParameterSpec displacement(const char* name, const char* meaning, Follows follows) {
  return {name, 0, {-1e12, 1e12}, {-1e12, 1e12}, false, Quantity::length, meaning, follows};
}

/// Returns the description of an angle (rad), zero by default.
constexpr ParameterSpec angle(const char* name, Range frozen, Range dynamic, const char* meaning,
                              Follows follows) {
  return {name, 0, frozen, dynamic, false, Quantity::angle, meaning, follows};
}

/// Returns the description of a number without a unit.
constexpr ParameterSpec ratio(const char* name, double standard, Range frozen, Range dynamic,
                              const char* meaning, Follows follows) {
  return {name, standard, frozen, dynamic, false, Quantity::ratio, meaning, follows};
}

/// Returns the description of a squareness exponent of a superquadric. If the exponent is a degree of
/// freedom, its range is [0.1, 1.9], the usual range in superquadric fitting; the surface has cusps above 2.
constexpr ParameterSpec exponent(const char* name, const char* meaning, Follows follows) {
  return {name, 1.0, {0.02, 5.0}, {0.1, 1.9}, false, Quantity::exponent, meaning, follows};
}

}  // namespace pliant
