// Function bodies of pressure.h.
#pragma once

#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/local/shell/pressure.h>
#include <pliant/local/solid/element_matrix.h>
#include <pliant/math/header_only.h>

namespace pliant {

namespace detail {

/// Returns the outward unit normals of a batch of triangles, each multiplied by twice the area of its
/// triangle, m^2.
inline Vec3<Pack> twice_area_vector(const ElementBatches<3>::Corners& x) {
  return Vec3<Pack>(x[1] - x[0]).cross(Vec3<Pack>(x[2] - x[0]));
}

/// Number of batches that one task of the thread pool sums.
inline constexpr int kPressureRange = 512;

}  // namespace detail

PLIANT_INLINE Pressure::Pressure(const ShellMesh& mesh) : batches_(mesh.triangles(), mesh.n_nodes()) {
  const std::vector<ShellEdge> edges = shell_edges(mesh);
  edges_.resize(4, static_cast<Eigen::Index>(edges.size()));
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const ShellEdge& edge = edges[e];
    if (!edge.inside())
      throw std::invalid_argument("a shell under pressure must be closed; the edge between nodes " +
                                  std::to_string(edge.a) + " and " + std::to_string(edge.b) +
                                  " has one triangle only");
    edges_.col(static_cast<Eigen::Index>(e)) << edge.a, edge.b, mesh.triangles()(edge.left_corner, edge.left),
        mesh.triangles()(edge.right_corner, edge.right);
  }
  const double V = volume(mesh.X().reshaped());
  if (!(V > 0))
    throw std::invalid_argument("a shell under pressure must enclose a volume; its volume is " +
                                std::to_string(V) +
                                " m^3 (corners of triangles must run counter-clockwise seen from outside)");
}

template <class F>
double Pressure::sum(double* parts, ThreadPool* pool, F&& f) const {
  for_ranges(batches_.n_batches(), detail::kPressureRange, pool, [&](int first, int last) {
    for (int b = first; b < last; ++b) {
      const Pack four = f(b);
      parts[b] = 0;
      for (int lane = 0; lane < batches_.lanes(b); ++lane) parts[b] += four[lane];
    }
  });
  double total = 0;
  for (int b = 0; b < batches_.n_batches(); ++b) total += parts[b];
  return total;
}

PLIANT_INLINE double Pressure::volume(const Coordinates& x, double* parts, ThreadPool* pool) const {
  // Positions are relative to node 0, to avoid cancellation in a shell far from the origin.
  const Eigen::Index n = batches_.n_nodes();
  const Vec3<Pack> origin(x[0], x[n], x[2 * n]);
  return sum(parts, pool,
             [&](int b) -> Pack {
               const ElementBatches<3>::Corners corner = batches_.corners(x, b);
               return Vec3<Pack>(corner[0] - origin).dot(detail::twice_area_vector(corner));
             }) /
         6;
}

PLIANT_INLINE double Pressure::volume(const Coordinates& x) const {
  std::vector<double> parts(static_cast<std::size_t>(batches_.n_batches()));
  return volume(x, parts.data(), nullptr);
}

PLIANT_INLINE double Pressure::energy(const Coordinates& x) const {
  return law(volume(x)).E;
}

PLIANT_INLINE void Pressure::add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer,
                                       ThreadPool* pool) const {
  buffer.numbers.resize(batches_.buffer_size());
  double* numbers = buffer.numbers.data();
  const Pack sixth_p = -law(volume(x, numbers, pool)).slope / 6;
  batches_.add(f, numbers, pool, [&](int b) -> ElementBatches<3>::Corners {
    const Vec3<Pack> third = sixth_p * detail::twice_area_vector(batches_.corners(x, b));
    return {third, third, third};
  });
}

PLIANT_INLINE void Pressure::add_derivative(const Coordinates& x, const Coordinates& dx, VecX<double>& f,
                                            Buffer& buffer, ThreadPool* pool) const {
  buffer.numbers.resize(batches_.buffer_size());
  double* numbers = buffer.numbers.data();
  const Law now = law(volume(x, numbers, pool));
  const double dV =
      sum(numbers, pool,
          [&](int b) -> Pack {
            const ElementBatches<3>::Corners d = batches_.corners(dx, b);
            return Vec3<Pack>(d[0] + d[1] + d[2]).dot(detail::twice_area_vector(batches_.corners(x, b)));
          }) /
      6;
  const Pack sixth_p = -now.slope / 6, sixth_dp = -now.curvature * dV / 6;
  batches_.add(f, numbers, pool, [&](int b) -> ElementBatches<3>::Corners {
    const ElementBatches<3>::Corners c = batches_.corners(x, b), d = batches_.corners(dx, b);
    const Vec3<Pack> p = c[1] - c[0], q = c[2] - c[0], dp = d[1] - d[0], dq = d[2] - d[0];
    const Vec3<Pack> third = sixth_p * (dp.cross(q) + p.cross(dq)) + sixth_dp * p.cross(q);
    return {third, third, third};
  });
}

/// d2V/dx2 couples only the ends a and b of each edge: d2V/(dx_a dx_b) = -skew(x_c - x_d)/6, with the
/// opposite nodes c and d.
template <class Visit>
void Pressure::each_element(const Coordinates& x, Visit&& visit) const {
  const double slope = law(volume(x)).slope;
  const int n = batches_.n_nodes();
  const auto at = nodes(x, n);
  for (Eigen::Index e = 0; e < edges_.cols(); ++e) {
    const int a = edges_(0, e), b = edges_(1, e);
    const Vec3<double> across = at.row(edges_(2, e)) - at.row(edges_(3, e));
    const Mat3<double> ab = -slope / 6 * skew(across);
    ElementMatrix<6> element{{a, a + n, a + 2 * n, b, b + n, b + 2 * n}, {}};
    element.K << Mat3<double>::Zero(), ab, ab.transpose(), Mat3<double>::Zero();
    visit(element);
  }
}

PLIANT_INLINE void Pressure::add_stiffness(const Coordinates& x,
                                           std::vector<Eigen::Triplet<double>>& K) const {
  add_triplets([&](auto&& visit) { each_element(x, visit); }, K);
}

PLIANT_INLINE double Pressure::frequency_bound(const Coordinates& x, const VecX<double>& M) const {
  const VecX<double> w = rank_one(x);
  return largest_element_frequency([&](auto&& visit) { each_element(x, visit); }, M) +
         w.cwiseAbs2().cwiseQuotient(M.head(w.size())).sum();
}

PLIANT_INLINE VecX<double> Pressure::rank_one(const Coordinates& x) const {
  VecX<double> w = VecX<double>::Zero(x.size());
  std::vector<double> numbers(batches_.buffer_size());
  batches_.add(w, numbers.data(), nullptr, [&](int b) -> ElementBatches<3>::Corners {
    const Vec3<Pack> third = Pack(1.0 / 6) * detail::twice_area_vector(batches_.corners(x, b));
    return {third, third, third};
  });
  return std::sqrt(law(volume(x)).curvature) * w;
}

PLIANT_INLINE ConstantPressure::ConstantPressure(const ShellMesh& mesh, double p) : Pressure(mesh), p_(p) {
  if (!std::isfinite(p))
    throw std::invalid_argument("the pressure is " + std::to_string(p) + " Pa; it must be finite");
}

PLIANT_INLINE Pressure::Law ConstantPressure::law(double V) const {
  return {-p_ * V, -p_, 0};
}

PLIANT_INLINE GasPressure::GasPressure(const ShellMesh& mesh, const Gas& gas) : Pressure(mesh), gas_(gas) {
  if (!(gas.p0 >= 0) || !(gas.V0 > 0) || !(gas.gamma >= 1) || !std::isfinite(gas.p_ext)) {
    std::ostringstream text;
    text << "a gas has p0 = " << gas.p0 << " Pa, V0 = " << gas.V0 << " m^3, gamma = " << gas.gamma
         << " and p_ext = " << gas.p_ext << " Pa; it needs p0 >= 0, V0 > 0, gamma >= 1 and a finite p_ext";
    throw std::invalid_argument(text.str());
  }
}

PLIANT_INLINE Pressure::Law GasPressure::law(double V) const {
  if (!(V > 0)) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan, nan};
  }
  const double compression = gas_.V0 / V, p = gas_.p0 * std::pow(compression, gas_.gamma);
  const double E_gas = gas_.gamma == 1 ? gas_.p0 * gas_.V0 * std::log(compression) : p * V / (gas_.gamma - 1);
  return {E_gas + gas_.p_ext * V, gas_.p_ext - p, gas_.gamma * p / V};
}

}  // namespace pliant
