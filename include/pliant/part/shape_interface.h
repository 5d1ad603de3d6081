// ShapeInterface: the interface of a shape with virtual functions, for Part::prepare(), contact search and
// output. The dynamics uses templates instead (shape_jets.h). shape/shape.h documents the members of a shape.
// Optional members have defaults here.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include <pliant/shape/shape.h>

namespace pliant {

/// The parameters a of a shape, as an array.
using ShapeParameters = const double*;

class ShapeInterface {
 public:
  virtual ~ShapeInterface() = default;
  virtual const char* name() const = 0;
  virtual const char* formula() const = 0;
  virtual const ParameterSpec* parameters() const = 0;
  virtual int n_parameters() const = 0;
  virtual MeshPattern mesh() const = 0;

  /// Returns the position e(u; a) (m, body frame), Eq. (3).
  virtual Vec3<double> e(const Material<double>& m, ShapeParameters a) const = 0;
  /// Returns h, half the extent along z, m. Global deformations use zeta = z / h.
  virtual double half_height(ShapeParameters a) const = 0;
  /// Returns w of the material point at x (m): 1 on the surface, below 1 inside, above 1 outside.
  virtual double gauge(const Vec3<double>& x, ShapeParameters a) const = 0;
  /// Returns the gradient of gauge() at x (m), 1/m. On the surface the gradient has the direction of the
  /// outward normal.
  virtual Vec3<double> gauge_gradient(const Vec3<double>& x, ShapeParameters a) const = 0;
  /// Returns the material point (u, v, w) with e(u, v, w) = x (m).
  virtual Material<double> label(const Vec3<double>& x, ShapeParameters a) const = 0;
  /// Returns the material point of the surface for a mesh vertex. g: direction of the vertex in the mesh
  /// pattern, or for MeshPattern::torus (angle around the tube, angle around z, 0), rad.
  virtual Material<double> mesh_label(const Vec3<double>& g, ShapeParameters a) const = 0;
  /// Returns the semi-axes if the shape is an ellipsoid, m; else nullopt.
  virtual std::optional<Vec3<double>> semi_axes(ShapeParameters a) const = 0;
  /// Returns the half sizes if the shape is a box, m; else nullopt.
  virtual std::optional<Vec3<double>> half_sizes(ShapeParameters a) const = 0;
  /// Returns the number of pieces whose convex hull equals the convex hull of the solid; 0 if the shape has
  /// no support function.
  virtual int hull_pieces() const = 0;
  /// Returns the point (metres, body frame) of a piece of the hull that is farthest in the direction of the
  /// vector m. m: body frame, not zero. piece: from 0. The farthest of the points of all pieces is on the
  /// surface.
  virtual Vec3<double> support(const Vec3<double>& m, ShapeParameters a, int piece) const = 0;
  /// Returns support() and its derivatives along the dual parts of m. Where these derivatives do not exist
  /// (at the axis of an end face, and for exponents below 1 at m_x = 0, m_y = 0 or m_z = 0) some of them are
  /// zero.
  virtual Vec3<Dual<3>> support(const Vec3<Dual<3>>& m, ShapeParameters a, int piece) const = 0;
  /// Whether contact may use the support function (shape/shape.h).
  virtual bool has_support(ShapeParameters a) const = 0;
  /// Whether a piece of the hull has nearly flat regions, other than end faces.
  virtual bool has_flat_regions(ShapeParameters a) const = 0;
  /// Whether pieces 0 and 1 of the hull are flat faces with the normals z and -z.
  virtual bool has_end_faces() const = 0;
  /// Whether the solid is equal to its convex hull.
  virtual bool is_convex(ShapeParameters a) const = 0;
  /// Returns e and its derivatives along three directions in (u, v, w). The dual parts of m define these
  /// directions; see material_with_tangents().
  virtual Vec3<Dual<3>> tangents(const Material<Dual<3>>& m, ShapeParameters a) const = 0;

  /// Whether the strain stays bounded when an exponent changes. For the trigonometric map of superquadrics
  /// the strain is unbounded: if an exponent eps changes from eps_0 to p eps_0 with p < 1, the deformation
  /// gradient grows as |x|^(p - 1) towards a coordinate plane x = 0.
  virtual bool bounded_exponents() const = 0;
  /// Whether e is linear in the parameters that are lengths, for all values of the other parameters.
  virtual bool linear_lengths() const = 0;

  // Quadrature. The rest map maps (u, v, w) to the quadrature points of the shape at rest. The rest map is e
  // of this shape, or e of another shape with an equal solid (member RestMap).

  /// Returns the rest map and its derivatives, as tangents() does for e.
  virtual Vec3<Dual<3>> rest_tangents(const Material<Dual<3>>& m, ShapeParameters a) const = 0;
  /// Returns the material point of the shape at the position that the rest map gives for m.
  virtual Material<double> from_rest_map(const Material<double>& m, ShapeParameters a) const = 0;
  /// Returns the panels (shape/panel.h) of the quadrature along u. dynamic_exponents: whether an exponent is
  /// a degree of freedom.
  virtual std::vector<Panel> profile(ShapeParameters a, bool dynamic_exponents) const = 0;
  /// Returns the panels of the quadrature along v. The argument is that of profile().
  virtual std::vector<Panel> ring(ShapeParameters a, bool dynamic_exponents) const = 0;
  /// Returns the exponent eps of the superellipse (C_v^eps, S_v^eps) that a ring (u, w) = const of the rest
  /// map follows, with C_v = cos v and S_v = sin v; 1 for an ellipse.
  virtual double ring_exponent(ShapeParameters a) const = 0;
  /// Whether the plane sections z = const of the shape are known in closed form.
  virtual bool has_sections() const = 0;
  /// Returns the area and the means of x^2 and y^2 of the plane section at zeta = z / h. gap: 1 - |zeta|.
  /// Must be called only if has_sections().
  virtual Section section(double zeta, double gap, ShapeParameters a) const = 0;
  /// Returns the panels of the quadrature along zeta over plane sections; empty if has_sections() is false.
  virtual std::vector<SectionPanel> section_panels(ShapeParameters a) const = 0;
};

/// Returns the material point at x (m) of a shape that has no label function; for x = 0 the centre w = 0.
/// Newton's method solves e(u, v, w) = x and starts in the direction of x. Throws std::runtime_error if the
/// method does not converge. A shape that is not star-shaped needs a label function.
Material<double> generic_label(const ShapeInterface& shape, const Vec3<double>& x, ShapeParameters a);
/// Returns the gradient of the radial coordinate w at x (m), 1/m, for a shape that has no label function. At
/// the poles the result is the limit along a meridian. Throws as generic_label() does.
Vec3<double> generic_gauge_gradient(const ShapeInterface& shape, const Vec3<double>& x, ShapeParameters a);

namespace detail {

// RestMapOf<Shape>::Map is the member RestMap of a shape, or the shape itself. has_NAME<Shape> is true if the
// shape has the optional member NAME.
template <class Shape, class = void>
struct RestMapOf {
  using Map = Shape;
};
template <class Shape>
struct RestMapOf<Shape, std::void_t<typename Shape::RestMap>> {
  using Map = typename Shape::RestMap;
};
#define PLIANT_HAS_MEMBER(member)             \
  template <class Shape, class = void>        \
  inline constexpr bool has_##member = false; \
  template <class Shape>                      \
  inline constexpr bool has_##member<Shape, std::void_t<decltype(&Shape::member)>> = true;
PLIANT_HAS_MEMBER(label)
PLIANT_HAS_MEMBER(mesh_label)
PLIANT_HAS_MEMBER(semi_axes)
PLIANT_HAS_MEMBER(half_sizes)
PLIANT_HAS_MEMBER(hull_pieces)
PLIANT_HAS_MEMBER(has_support)
PLIANT_HAS_MEMBER(has_flat_regions)
PLIANT_HAS_MEMBER(has_end_faces)
PLIANT_HAS_MEMBER(is_convex)
PLIANT_HAS_MEMBER(profile)
PLIANT_HAS_MEMBER(ring)
PLIANT_HAS_MEMBER(ring_exponent)
PLIANT_HAS_MEMBER(section)
PLIANT_HAS_MEMBER(bounded_exponents)
PLIANT_HAS_MEMBER(linear_lengths)
#undef PLIANT_HAS_MEMBER

}  // namespace detail

/// The ShapeInterface of a shape type.
template <class Shape>
class ShapeInterfaceOf final : public ShapeInterface {
  static constexpr int K = shape_size<Shape>;
  using RestMap = typename detail::RestMapOf<Shape>::Map;
  static Vec<double, K> vec(ShapeParameters a) { return Eigen::Map<const Vec<double, K>>(a); }
  template <class T>
  static Vec<T, K> lift(ShapeParameters a) {
    return vec(a).template cast<T>();
  }

 public:
  const char* name() const override { return Shape::name; }
  const char* formula() const override { return Shape::formula; }
  const ParameterSpec* parameters() const override { return Shape::parameters.data(); }
  int n_parameters() const override { return K; }
  MeshPattern mesh() const override { return Shape::mesh; }

  Vec3<double> e(const Material<double>& m, ShapeParameters a) const override {
    return Shape::template e<double>(m, vec(a));
  }
  double half_height(ShapeParameters a) const override { return Shape::template half_height<double>(vec(a)); }
  double gauge(const Vec3<double>& x, ShapeParameters a) const override {
    if constexpr (detail::has_label<Shape>)
      return Shape::template gauge<double>(x, vec(a));
    else
      return label(x, a).w;
  }
  Vec3<double> gauge_gradient(const Vec3<double>& x, ShapeParameters a) const override {
    if constexpr (detail::has_label<Shape>) {
      using D = Dual<3>;
      const Vec3<D> at{D::variable(x[0], 0), D::variable(x[1], 1), D::variable(x[2], 2)};
      const D g = Shape::template gauge<D>(at, lift<D>(a));
      return {g.d[0], g.d[1], g.d[2]};
    } else {
      return generic_gauge_gradient(*this, x, a);
    }
  }
  Material<double> label(const Vec3<double>& x, ShapeParameters a) const override {
    if constexpr (detail::has_label<Shape>)
      return Shape::label(x, vec(a));
    else
      return generic_label(*this, x, a);
  }
  Material<double> mesh_label(const Vec3<double>& g, ShapeParameters a) const override {
    if constexpr (detail::has_mesh_label<Shape>)
      return Shape::mesh_label(g, vec(a));
    else
      return material_towards(g);
  }
  std::optional<Vec3<double>> semi_axes(ShapeParameters a) const override {
    if constexpr (detail::has_semi_axes<Shape>)
      return Shape::semi_axes(vec(a));
    else
      return std::nullopt;
  }
  std::optional<Vec3<double>> half_sizes(ShapeParameters a) const override {
    if constexpr (detail::has_half_sizes<Shape>)
      return Shape::half_sizes(vec(a));
    else
      return std::nullopt;
  }
  int hull_pieces() const override {
    if constexpr (detail::has_hull_pieces<Shape>) {
      static_assert(Shape::hull_pieces <= kMaxHullPieces);
      return Shape::hull_pieces;
    } else {
      return 0;
    }
  }
  Vec3<double> support(const Vec3<double>& m, ShapeParameters a, int piece) const override {
    if constexpr (detail::has_hull_pieces<Shape>)
      return Shape::template support<double>(m, vec(a), piece);
    else
      return Vec3<double>::Zero();
  }
  Vec3<Dual<3>> support(const Vec3<Dual<3>>& m, ShapeParameters a, int piece) const override {
    if constexpr (detail::has_hull_pieces<Shape>)
      return Shape::template support<Dual<3>>(m, lift<Dual<3>>(a), piece);
    else
      return {};
  }
  bool has_support(ShapeParameters a) const override {
    if constexpr (detail::has_has_support<Shape>)
      return Shape::has_support(vec(a));
    else
      return detail::has_hull_pieces<Shape>;
  }
  bool has_end_faces() const override { return detail::has_has_end_faces<Shape>; }
  bool is_convex(ShapeParameters a) const override {
    if constexpr (detail::has_is_convex<Shape>)
      return Shape::is_convex(vec(a));
    else
      return detail::has_hull_pieces<Shape>;
  }
  bool has_flat_regions(ShapeParameters a) const override {
    if constexpr (detail::has_has_flat_regions<Shape>)
      return Shape::has_flat_regions(vec(a));
    else
      return true;
  }
  Vec3<Dual<3>> tangents(const Material<Dual<3>>& m, ShapeParameters a) const override {
    return Shape::template e<Dual<3>>(m, lift<Dual<3>>(a));
  }
  bool bounded_exponents() const override { return detail::has_bounded_exponents<Shape>; }
  bool linear_lengths() const override { return detail::has_linear_lengths<Shape>; }
  Vec3<Dual<3>> rest_tangents(const Material<Dual<3>>& m, ShapeParameters a) const override {
    return RestMap::template e<Dual<3>>(m, lift<Dual<3>>(a));
  }
  Material<double> from_rest_map(const Material<double>& m, ShapeParameters a) const override {
    if constexpr (std::is_same_v<RestMap, Shape>)
      return m;
    else
      return Shape::label(RestMap::template e<double>(m, vec(a)), vec(a));
  }
  std::vector<Panel> profile(ShapeParameters a, bool dynamic_exponents) const override {
    if constexpr (detail::has_profile<RestMap>)
      return RestMap::profile(vec(a), dynamic_exponents);
    else
      return {{Panel::Kind::smooth, -kPi / 2, kPi / 2}};
  }
  std::vector<Panel> ring(ShapeParameters a, bool dynamic_exponents) const override {
    if constexpr (detail::has_ring<RestMap>)
      return RestMap::ring(vec(a), dynamic_exponents);
    else
      return {{Panel::Kind::periodic, 0, 2 * kPi}};
  }
  double ring_exponent(ShapeParameters a) const override {
    if constexpr (detail::has_ring_exponent<Shape>)
      return Shape::ring_exponent(vec(a));
    else
      return 1;
  }
  bool has_sections() const override { return detail::has_section<Shape>; }
  Section section(double zeta, double gap, ShapeParameters a) const override {
    if constexpr (detail::has_section<Shape>)
      return Shape::section(zeta, gap, vec(a));
    else
      return {};
  }
  std::vector<SectionPanel> section_panels(ShapeParameters a) const override {
    if constexpr (detail::has_section<Shape>)
      return Shape::section_panels(vec(a));
    else
      return {};
  }
};

}  // namespace pliant
