// The interface of a shape: one struct with its names, its parameters and its formula e(u; a), Eq. (3).
//
// Required members:
//   name, formula     texts for scene files, messages and `pliant list`
//   parameters        std::array<ParameterSpec, n>
//   e(m, a)           point of the solid (m, body frame) at material point m; templated on both scalars
//   half_height(a)    h (m), half the extent along z; deformations use zeta = z / h
//   mesh              grid pattern of the surface
//
// Optional members, closed forms that are faster than the general search and exact at the poles:
//   gauge(x, a)       w of the point x: 0 at the centre, 1 on the surface, above 1 outside; never overflows
//   label(x, a)       material point of x, the inverse of e; needs gauge
//   mesh_label(g, a)  surface point in the direction g of the mesh pattern
//   profile(a, moving), ring(a, moving)  quadrature panels along u and along v; e is smooth on each panel.
//                     moving: whether an exponent is a degree of freedom
//   ring_exponent(a)  exponent of the superellipse that a ring (u, w) = const follows
//   RestMap           another shape with an equal surface whose material map generates the quadrature points
//   semi_axes(a)      for an ellipsoid: its point in the unit direction y of the mesh pattern is y times
//                     these, entry by entry
//   half_sizes(a)     for a box about the origin: its half sizes
//   bounded_exponents true if a changing exponent strains the material by bounded amounts
//   linear_lengths    true if e is linear in the parameters that are lengths, for all values of the others
//   section(zeta, gap, a), section_panels(a)  area and mean squares of the section of the solid at zeta, with
//                     gap = 1 - |zeta|; intervals of zeta on which the section is smooth
#pragma once

#include <array>
#include <vector>

#include <pliant/math/parameter_spec.h>
#include <pliant/math/scalar/dual.h>
#include <pliant/shape/material.h>
#include <pliant/shape/panel.h>

namespace pliant {

/// A plane section z = const of a shape, symmetric about both axes.
struct Section {
  double area;    ///< m^2
  double xx, yy;  ///< mean of x^2 and y^2, m^2
};

/// The grid pattern of a closed surface.
enum class MeshPattern { ball, torus };

/// Number of parameters of a shape.
template <class Shape>
inline constexpr int shape_size = static_cast<int>(Shape::parameters.size());

/// All parameters of a shape, over the scalar T.
template <class Shape, class T>
using ShapeVec = Vec<T, shape_size<Shape>>;

}  // namespace pliant
