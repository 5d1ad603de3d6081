// What a shape or a deformation says about each of its parameters: name, default, ranges, unit, meaning.
#pragma once

#include <limits>

namespace pliant {

struct Range {
  double min, max;
  constexpr bool contains(double x) const { return x >= min && x <= max; }
};

/// How a material point follows a parameter; it decides which quadrature of the mass is exact (design 1.3).
enum class Follows {
  affine,   ///< its displacement is affine in the rest position
  section,  ///< affine in (x, y) within each section z = const of the rest shape
  ring,     ///< affine in (x, y) along each material ring (u, w) = const
  free,     ///< none of these
};

/// What a parameter measures.
enum class Quantity {
  length,    ///< m; it scales with the body
  angle,     ///< rad
  exponent,  ///< squareness of a superquadric
  ratio,     ///< any other number without a unit
};

struct ParameterSpec {
  const char* name;
  double standard;  ///< default value
  Range frozen;     ///< where it may be held
  Range dynamic;    ///< where it may move as a degree of freedom (one-sided limits)
  bool relative;    ///< the dynamic range is in multiples of the rest value
  Quantity quantity;
  const char* meaning;
  Follows follows;

  constexpr const char* unit() const {
    return quantity == Quantity::length ? "m" : quantity == Quantity::angle ? "rad" : "1";
  }
};

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A positive length; as a degree of freedom it keeps above a thousandth of its rest value.
constexpr ParameterSpec length(const char* name, double standard, const char* meaning,
                               Follows follows = Follows::affine) {
  return {name, standard, {1e-12, 1e12}, {1e-3, 1e3}, true, Quantity::length, meaning, follows};
}

/// A displacement: a length of either sign, zero unless given.
constexpr ParameterSpec displacement(const char* name, const char* meaning, Follows follows) {
  return {name, 0, {-1e12, 1e12}, {-1e12, 1e12}, false, Quantity::length, meaning, follows};
}

/// An angle, zero unless given.
constexpr ParameterSpec angle(const char* name, Range frozen, Range dynamic, const char* meaning,
                              Follows follows) {
  return {name, 0, frozen, dynamic, false, Quantity::angle, meaning, follows};
}

/// A number without a unit.
constexpr ParameterSpec ratio(const char* name, double standard, Range frozen, Range dynamic,
                              const char* meaning, Follows follows) {
  return {name, standard, frozen, dynamic, false, Quantity::ratio, meaning, follows};
}

/// A squareness exponent (design 6).
constexpr ParameterSpec exponent(const char* name, const char* meaning, Follows follows) {
  return {name, 1.0, {0.02, 5.0}, {0.1, 1.9}, false, Quantity::exponent, meaning, follows};
}

}  // namespace pliant
