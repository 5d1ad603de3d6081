// What a shape is (design 1.1): one struct with its names, its parameters and its formula, e(u; a), Eq. (3).
//   name, formula     for people and scene files
//   parameters        std::array<ParameterSpec, n>
//   e(m, a)           the point of the solid at material point m, parameters a; templated on its scalars
//   half_height(a)    h, half the extent along z, by which deformations measure zeta = z / h
//   mesh              which grid covers its surface
// That is all a shape needs. Closed forms for more are faster, and exact at the poles:
//   gauge(x, a)       w of the point x: 0 at the centre, 1 on the surface, above 1 outside; never overflows
//   label(x, a)       the whole material point of x, the inverse of e; goes with gauge
//   mesh_label(g, a)  the surface point in the direction g of the mesh pattern
//   profile(a, moving), ring(a, moving)  panels along u and v between which e is smooth, for quadrature;
//                     moving: its exponents are dynamic
//   semi_axes(a)      of a shape that is a stretched ball: its point in the direction y of the mesh pattern,
//                     of length 1, is y times these, entry by entry
//   half_sizes(a)     of a shape that is a box about its origin
//   bounded_exponents true: a changing exponent strains the material by bounded amounts
//   linear_lengths true: e is linear in the parameters that are lengths, whatever the others are
//   section(zeta, gap, a), section_panels(a)  area and mean squares of the section at zeta, gap = 1 - |zeta|,
//                     of the solid, and panels along zeta between which it is smooth
#pragma once

#include <array>
#include <vector>

#include <pliant/math/parameter_spec.h>
#include <pliant/math/scalar/dual.h>
#include <pliant/shape/material.h>
#include <pliant/shape/panel.h>

namespace pliant {

/// A plane section of a shape, symmetric about both axes.
struct Section {
  double area;    ///< m^2
  double xx, yy;  ///< mean of x^2 and y^2, m^2
};

/// How a closed surface is covered by a grid.
enum class MeshPattern { ball, torus };

template <class Shape>
inline constexpr int shape_size = static_cast<int>(Shape::parameters.size());

/// All parameters of a shape at one scalar.
template <class Shape, class T>
using ShapeVec = Vec<T, shape_size<Shape>>;

}  // namespace pliant
