// The interface of a shape. A shape is one struct with a name, parameters a and a formula e(u; a), Eq. (3).
//
// Required members:
//   name, formula     texts for scene files, messages and `pliant list`
//   parameters        std::array<ParameterSpec, n>, the n parameters a
//   e(m, a)           position (metres, body frame) of the material point m; a template on the scalars of m
//                     and a
//   half_height(a)    h (metres), half the extent along z; global deformations use zeta = z / h
//   mesh              MeshPattern of the surface mesh
//
// Optional members. ShapeInterfaceOf (part/shape_interface.h) has defaults for them. A shape has both gauge
// and label, or neither; a gauge without label is not used. The default of both is a Newton search, which
// needs a star-shaped solid. Closed forms in the shape are faster than this search, and exact at the poles.
//   gauge(x, a)       w at the position x: 0 at the centre, 1 on the surface, above 1 outside; must not
//                     overflow
//   label(x, a)       material point at the position x, the inverse of e; at the centre and on the z axis one
//                     of the material points there
//   mesh_label(g, a)  material point of the surface for a mesh vertex; g: direction of the vertex in the mesh
//                     pattern, or for MeshPattern::torus (angle around the tube, angle around z, 0), rad.
//                     Default: the material point towards g; MeshPattern::torus requires this member
//   profile(a, moving), ring(a, moving)  quadrature panels along u and along v; e is smooth on each panel.
//                     moving: whether an exponent is a degree of freedom. Default: one panel each, for
//                     -pi/2 <= u <= pi/2 and for the whole circle of v
//   ring_exponent(a)  exponent of the superellipse that a ring follows; a ring is a curve (u, w) = const
//   RestMap           another shape with the same parameters and an equal surface; its map e generates the
//                     quadrature points
//   semi_axes(a)      only for an ellipsoid: its semi-axes (metres). mesh_label must map the unit direction y
//                     to the surface point with the coordinates y_i times semi-axis i
//   half_sizes(a)     only for a box about the origin: its half sizes (metres)
//   hull_pieces       number of pieces of the convex hull. Each piece is convex, and the hull of the solid is
//                     the hull of all pieces
//   support(m, a, piece)  point of a piece (metres, body frame) that is farthest along the vector m, which
//                     has any length but zero; a template on the scalar of m and a. The farthest of these
//                     points of all pieces is on the surface. Requires hull_pieces, at most kMaxHullPieces
//   has_support(a)    whether contact may use the support function: no piece has flat faces or straight edges
//                     other than end faces. Default: true
//   has_flat_regions(a)  whether a piece has nearly flat regions, other than end faces. Default: true
//   has_end_faces     exists only if pieces 0 and 1 of the hull are flat faces with the normals z and -z; its
//                     value is not read
//   is_convex(a)      whether the solid is its hull; used only if has_support(a) is true. Default: true
//   bounded_exponents exists only if a changing exponent strains the material by bounded amounts; its value
//                     is not read
//   linear_lengths    exists only if e is linear in the parameters that are lengths, for all values of the
//                     other parameters; its value is not read
//   section(zeta, gap, a)  plane section of the solid at zeta (Section); gap = 1 - |zeta|
//   section_panels(a) intervals of zeta on which the section is smooth; required with section
#pragma once

#include <array>
#include <vector>

#include <pliant/math/parameter_spec.h>
#include <pliant/math/scalar/dual.h>
#include <pliant/shape/material.h>
#include <pliant/shape/panel.h>

namespace pliant {

/// A plane section z = const of a shape, symmetric about the x and y axes.
struct Section {
  double area;    ///< m^2
  double xx, yy;  ///< means of x^2 and of y^2 over the section, m^2
};

/// The pattern of the surface mesh of a shape.
enum class MeshPattern { ball, torus };

/// Largest number of pieces of the convex hull of a shape.
inline constexpr int kMaxHullPieces = 8;

/// Number of parameters of a shape.
template <class Shape>
inline constexpr int shape_size = static_cast<int>(Shape::parameters.size());

/// All parameters of a shape, over the scalar T.
template <class Shape, class T>
using ShapeVec = Vec<T, shape_size<Shape>>;

}  // namespace pliant
