// Function bodies of bending.h.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/SparseCholesky>

#include <pliant/local/shell/bending.h>
#include <pliant/local/solid/element_matrix.h>
#include <pliant/math/scalar/dual.h>

namespace pliant {

namespace detail {

/// Number of batches that one task of the thread pool evaluates.
inline constexpr int kBendingRange = 256;
/// Rest angles up to this value, rad, are treated as rounding errors of a flat mesh.
inline constexpr double kFlatHinge = 1e-12;

/// Returns Q of a triangle (bending.h), N m. e: its edges, m.
inline Mat3<double> mid_edge_stiffness(const Edges<double>& e, const Sheet& sheet) {
  const double area = 0.5 * e[0].cross(e[1]).norm();
  Mat3<double> Q;
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) {
      const Vec3<double>&a = e[static_cast<std::size_t>(k)], &b = e[static_cast<std::size_t>(l)];
      const double lengths = a.norm() * b.norm(), dot = a.dot(b);
      Q(k, l) =
          sheet.bending_stiffness() / area * ((1 - sheet.nu) * dot * dot / lengths + sheet.nu * lengths);
    }
  return Q;
}

/// Returns the nodes a, b, c, d (hinge.h) of every edge between two triangles, one column for each edge.
inline Eigen::Matrix4Xi hinge_nodes(const ShellMesh& mesh, const std::vector<ShellEdge>& edges) {
  const auto n = std::count_if(edges.begin(), edges.end(), [](const ShellEdge& e) { return e.inside(); });
  Eigen::Matrix4Xi nodes(4, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ShellEdge& edge = edges[static_cast<std::size_t>(i)];
    nodes.col(i) << edge.a, edge.b, mesh.triangles()(edge.left_corner, edge.left),
        mesh.triangles()(edge.right_corner, edge.right);
  }
  return nodes;
}

inline Pack gather_pack(const double* from, const std::array<int, Pack::kLanes>& index) {
  return {from[index[0]], from[index[1]], from[index[2]], from[index[3]]};
}

inline HingeCorners<Pack> scaled_corners(const Pack& factor, const HingeCorners<Pack>& a) {
  return {factor * a[0], factor * a[1], factor * a[2], factor * a[3]};
}

/// Returns the change of the hinge gradient dtheta/dx to first order when the corners x (m) move by dx.
inline HingeCorners<Pack> hinge_gradient_change(const HingeCorners<Pack>& x, const HingeCorners<Pack>& dx) {
  using D = Dual<1, Pack>;
  HingeCorners<D> moving;
  for (std::size_t k = 0; k < 4; ++k)
    for (int i = 0; i < 3; ++i) {
      moving[k][i].v = x[k][i];
      moving[k][i].d[0] = dx[k][i];
    }
  const HingeCorners<D> gradient = hinge_gradient(moving);
  HingeCorners<Pack> change;
  for (std::size_t k = 0; k < 4; ++k)
    for (int i = 0; i < 3; ++i) change[k][i] = gradient[k][i].d[0];
  return change;
}

}  // namespace detail

template <class Hinges>
MidEdgeBending<Hinges>::MidEdgeBending(const ShellMesh& mesh, const Sheet& sheet, double area_density)
    : n_nodes_(mesh.n_nodes()),
      triangle_nodes_(mesh.triangles()),
      edges_(shell_edges(mesh)),
      hinge_batches_(detail::hinge_nodes(mesh, edges_), mesh.n_nodes()),
      triangle_batches_(mesh.triangles(), mesh.n_nodes()),
      hinges_(hinge_batches_, triangle_batches_, mesh.X().reshaped()),
      triangles_(static_cast<std::size_t>((mesh.n_triangles() + Pack::kLanes - 1) / Pack::kLanes)),
      moment_index_(edges_.size()),
      own_inertia_(VecX<double>::Zero(static_cast<Eigen::Index>(edges_.size()))) {
  sheet.check();
  if (!(area_density > 0) || !std::isfinite(area_density))
    throw std::invalid_argument("the mass of a sheet for each unit of area is " +
                                std::to_string(area_density) + " kg/m^2; it must be positive and finite");
  n_hinges_ = hinge_batches_.n_elements();
  const int n_triangles = static_cast<int>(mesh.n_triangles());
  for (int t = 0; t < Pack::kLanes * static_cast<int>(triangles_.size()); ++t) {
    Triangles& triangles = triangles_[static_cast<std::size_t>(t / Pack::kLanes)];
    const bool padding = t >= n_triangles;
    const Mat3<double> Q = detail::mid_edge_stiffness(edges_of(mesh, std::min(t, n_triangles - 1)), sheet);
    for (int k = 0; k < 3; ++k) {
      const auto corner = static_cast<std::size_t>(k);
      triangles.Q_diagonal[corner].set(t % Pack::kLanes, padding ? 0 : Q(k, k));
      triangles.Q_off_diagonal[corner].set(t % Pack::kLanes, padding ? 0 : Q((k + 1) % 3, (k + 2) % 3));
      triangles.side[corner].set(t % Pack::kLanes, 1);
      triangles.edge[corner][static_cast<std::size_t>(t % Pack::kLanes)] = 0;
      triangles.angle[corner][static_cast<std::size_t>(t % Pack::kLanes)] = 0;
    }
  }
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const ShellEdge& edge = edges_[e];
    // Registers edge e as edge k of triangle t. Returns the index of the moment at this edge of the triangle.
    auto attach = [&](int t, int k, double side) {
      Triangles& triangles = triangles_[static_cast<std::size_t>(t / Pack::kLanes)];
      const auto corner = static_cast<std::size_t>(k), lane = static_cast<std::size_t>(t % Pack::kLanes);
      triangles.side[corner].set(t % Pack::kLanes, side);
      triangles.edge[corner][lane] = static_cast<int>(e);
      triangles.angle[corner][lane] = edge.inside() ? static_cast<int>(e) : n_angles() - 1;
      own_inertia_[static_cast<Eigen::Index>(e)] +=
          area_density * sheet.thickness * sheet.thickness / 12 * mesh.area(t) / 3;
      return (t / Pack::kLanes * 3 + k) * Pack::kLanes + t % Pack::kLanes;
    };
    moment_index_[e][0] = attach(edge.left, edge.left_corner, 1);
    if (edge.inside()) moment_index_[e][1] = attach(edge.right, edge.right_corner, -1);
  }
  set_coupling(mesh);
}

/// Returns the angles theta of all hinges at rest, rad.
template <class Hinges>
std::vector<double> MidEdgeBending<Hinges>::rest_angles(const ShellMesh& mesh) const {
  std::vector<double> angles(static_cast<std::size_t>(n_angles()), 0.0);
  const VecX<double> X = mesh.X().reshaped();
  for (int b = 0; b < hinge_batches_.n_batches(); ++b) {
    const math::SinCos<Pack> theta = hinge_sin_cos(hinge_batches_.corners(X, b));
    for (int lane = 0; lane < Pack::kLanes; ++lane)
      angles[static_cast<std::size_t>(Pack::kLanes * b + lane)] =
          std::atan2(theta.sin[lane], theta.cos[lane]);
  }
  return angles;
}

/// Returns the angles phi (rad) that minimise 1/2 sum alpha Q alpha for the angles theta of the hinges. These
/// phi define the normals of the rest shape.
template <class Hinges>
VecX<double> MidEdgeBending<Hinges>::rest_rotations(const double* angles) const {
  const PerEdge none{0.0, 0.0, 0.0};
  std::vector<double> m(n_moments());
  VecX<double> phi = VecX<double>::Zero(own_inertia_.size()),
               f = VecX<double>::Zero(3 * n_nodes_ + phi.size());
  compute_moments(angles, phi.data(), m.data(), nullptr, [&](int) { return none; });
  add_own_forces(f, m.data());
  if (!(f.norm() > 0)) return phi;
  std::vector<Eigen::Triplet<double>> entries;
  for (int t = 0; t < triangle_nodes_.cols(); ++t) {
    const Triangles& triangles = triangles_[static_cast<std::size_t>(t / Pack::kLanes)];
    const auto lane = static_cast<std::size_t>(t % Pack::kLanes);
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t l = 0; l < 3; ++l) {
        const Pack& Q = k == l ? triangles.Q_diagonal[k] : triangles.Q_off_diagonal[3 - k - l];
        entries.emplace_back(triangles.edge[k][lane], triangles.edge[l][lane],
                             (triangles.side[k] * triangles.side[l] * Q)[t % Pack::kLanes]);
      }
  }
  Eigen::SparseMatrix<double> K(phi.size(), phi.size());
  K.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(K);
  phi = factor.solve(f.tail(phi.size()));
  return phi;
}

/// Computes C of all triangles from the curvature of the rest shape.
template <class Hinges>
void MidEdgeBending<Hinges>::set_coupling(const ShellMesh& mesh) {
  const std::vector<double> angles = rest_angles(mesh);
  const PerEdge none{0.0, 0.0, 0.0};
  for (Triangles& triangles : triangles_) triangles.C = {none, none, none};
  curved_ = std::any_of(angles.begin(), angles.end(),
                        [](double theta) { return std::abs(theta) > detail::kFlatHinge; });
  if (!curved_) return;
  const VecX<double> phi = rest_rotations(angles.data());
  for (int t = 0; t < Pack::kLanes * static_cast<int>(triangles_.size()); ++t)
    set_coupling(mesh, t, angles.data(), phi.data());
}

/// Computes C of triangle t. In lanes of the last batch without a triangle, C has no effect, because Q is 0
/// there. The curvature at rest is
///   b = 1/A sum_k alpha_k |e_k| n_k n_k^T,
/// and a strain eps of the triangle changes the curvature by
///   kappa = 1/A sum_k alpha_k (n_k . eps n_k) |e_k| n_k n_k^T - (b eps + eps b)/2,
/// because alpha_k is measured along an edge that moves. C q is the alpha that gives this kappa.
template <class Hinges>
void MidEdgeBending<Hinges>::set_coupling(const ShellMesh& mesh, int t, const double* angles,
                                          const double* phi) {
  const PerEdge none{0.0, 0.0, 0.0};
  Triangles& triangles = triangles_[static_cast<std::size_t>(t / Pack::kLanes)];
  const int lane = t % Pack::kLanes;
  const Edges<double> e = edges_of(mesh, std::min(t, static_cast<int>(triangle_nodes_.cols()) - 1));
  const std::array<Mat3<double>, 3> B = edge_strains(e);
  const PerEdge rest = rotations(triangles, angles, phi, none);
  const Vec3<double> normal = e[0].cross(e[1]).normalized();
  const double area = 0.5 * e[0].cross(e[1]).norm();
  std::array<Mat3<double>, 3> across;  // n_k n_k^T
  Mat3<double> b = Mat3<double>::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3<double> n = e[k].cross(normal).normalized();
    across[k] = n * n.transpose();
    b += rest[k][lane] * e[k].norm() / area * across[k];
  }
  for (std::size_t l = 0; l < 3; ++l) {
    Mat3<double> kappa = -0.5 * (b * B[l] + B[l] * b);
    for (std::size_t k = 0; k < 3; ++k)
      kappa += rest[k][lane] * across[k].cwiseProduct(B[l]).sum() * e[k].norm() / area * across[k];
    // alpha_k follows from the component of kappa along n_k n_k^T. With t_k = |e_k| n_k and the other two
    // edges i and j, the tensor dual to t_k t_k^T is -(e_i e_j^T + e_j e_i^T)/(8 A^2).
    for (std::size_t k = 0; k < 3; ++k)
      triangles.C[k][l].set(lane, -e[k].norm() * e[(k + 1) % 3].dot(kappa * e[(k + 2) % 3]) / (4 * area));
  }
}

template <class Hinges>
typename MidEdgeBending<Hinges>::Scratch MidEdgeBending<Hinges>::scratch(Buffer& buffer) const {
  const std::size_t corners = std::max(hinge_batches_.buffer_size(), triangle_batches_.buffer_size()),
                    angles = static_cast<std::size_t>(n_angles());
  buffer.numbers.resize(corners + 2 * angles + n_moments() + edges_.size());
  double* numbers = buffer.numbers.data();
  double* moments = numbers + corners + angles;
  return {numbers, numbers + corners, moments, moments + n_moments(), moments + n_moments() + angles};
}

template <class Hinges>
typename MidEdgeBending<Hinges>::PerEdge MidEdgeBending<Hinges>::rotations(const Triangles& triangles,
                                                                           const double* angles,
                                                                           const double* phi,
                                                                           const PerEdge& q) {
  PerEdge alpha;
  for (std::size_t k = 0; k < 3; ++k)
    alpha[k] = 0.5 * detail::gather_pack(angles, triangles.angle[k]) +
               triangles.side[k] * detail::gather_pack(phi, triangles.edge[k]) + triangles.C[k][0] * q[0] +
               triangles.C[k][1] * q[1] + triangles.C[k][2] * q[2];
  return alpha;
}

template <class Hinges>
typename MidEdgeBending<Hinges>::PerEdge MidEdgeBending<Hinges>::tensions(const Triangles& triangles,
                                                                          const PerEdge& m) {
  PerEdge tau;
  for (std::size_t l = 0; l < 3; ++l)
    tau[l] = triangles.C[0][l] * m[0] + triangles.C[1][l] * m[1] + triangles.C[2][l] * m[2];
  return tau;
}

template <class Hinges>
typename MidEdgeBending<Hinges>::PerEdge MidEdgeBending<Hinges>::moments_at(int batch,
                                                                            const double* m) const {
  const double* from = m + 3 * Pack::kLanes * batch;
  return {load(from), load(from + Pack::kLanes), load(from + 2 * Pack::kLanes)};
}

template <class Hinges>
typename MidEdgeBending<Hinges>::PerEdge MidEdgeBending<Hinges>::moments(const Triangles& triangles,
                                                                         const PerEdge& alpha) {
  PerEdge m;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    m[k] = triangles.Q_diagonal[k] * alpha[k] + triangles.Q_off_diagonal[j] * alpha[i] +
           triangles.Q_off_diagonal[i] * alpha[j];
  }
  return m;
}

template <class Hinges>
template <class Act>
void MidEdgeBending<Hinges>::for_each_hinge_batch(ThreadPool* pool, Act&& act) const {
  for_ranges(hinge_batches_.n_batches(), detail::kBendingRange, pool, [&](int first, int last) {
    for (int b = first; b < last; ++b) act(b);
  });
}

template <class Hinges>
void MidEdgeBending<Hinges>::unwrap(int batch, const Pack& turn, const double* own, const Scratch& to) const {
  for (int lane = 0; lane < hinge_batches_.lanes(batch); ++lane) {
    const int e = Pack::kLanes * batch + lane;
    to.phi[e] = own[e] - turn[lane];
    remove_turns(to.angles[e], to.phi[e]);
  }
}

template <class Hinges>
const double* MidEdgeBending<Hinges>::compute_rotations(const Coordinates& x, const Scratch& to,
                                                        ThreadPool* pool) const {
  const double* own = x.data() + 3 * n_nodes_;
  to.angles[n_angles() - 1] = 0;
  for_each_hinge_batch(pool, [&](int b) {
    const Corners corners = hinge_batches_.corners(x, b);
    const HingeAngles angles = hinges_.angles(b, corners);
    store(angles.change, to.angles + Pack::kLanes * b);
    if constexpr (Hinges::kOf == Of::position) {
      store(angles.turn.slope, to.slopes + Pack::kLanes * b);
      unwrap(b, angles.turn.value, own, to);
    }
  });
  if constexpr (Hinges::kOf != Of::position) return own;
  std::copy(own + n_hinges_, own + edges_.size(), to.phi + n_hinges_);
  return to.phi;
}

template <class Hinges>
const double* MidEdgeBending<Hinges>::compute_rotation_changes(const Coordinates& x, const Coordinates& dx,
                                                               const Scratch& to, ThreadPool* pool) const {
  const double* own = dx.data() + 3 * n_nodes_;
  to.angles[n_angles() - 1] = 0;
  for_each_hinge_batch(pool, [&](int b) {
    const Corners corners = hinge_batches_.corners(x, b);
    const Pack change = dot(hinges_.gradient(b, corners), hinge_batches_.corners(dx, b));
    store(change, to.angles + Pack::kLanes * b);
    if constexpr (Hinges::kOf == Of::position) {
      const Pack slope = hinges_.turn(b, corners).slope, turn = slope * change;
      store(slope, to.slopes + Pack::kLanes * b);
      for (int lane = 0; lane < hinge_batches_.lanes(b); ++lane)
        to.phi[Pack::kLanes * b + lane] = own[Pack::kLanes * b + lane] - turn[lane];
    }
  });
  if constexpr (Hinges::kOf != Of::position) return own;
  std::copy(own + n_hinges_, own + edges_.size(), to.phi + n_hinges_);
  return to.phi;
}

template <class Hinges>
template <class Strain>
void MidEdgeBending<Hinges>::compute_moments(const double* angles, const double* phi, double* to,
                                             ThreadPool* pool, Strain&& strain) const {
  for_ranges(static_cast<int>(triangles_.size()), detail::kBendingRange, pool, [&](int first, int last) {
    for (int b = first; b < last; ++b) {
      const Triangles& triangles = triangles_[static_cast<std::size_t>(b)];
      const PerEdge m = moments(triangles, rotations(triangles, angles, phi, strain(b)));
      for (int k = 0; k < 3; ++k) store(m[static_cast<std::size_t>(k)], to + (3 * b + k) * Pack::kLanes);
    }
  });
}

template <class Hinges>
void MidEdgeBending<Hinges>::compute_state(const Coordinates& x, const Scratch& to, ThreadPool* pool) const {
  const double* phi = compute_rotations(x, to, pool);
  compute_moments(to.angles, phi, to.moments, pool,
                  [&](int b) { return hinges_.strain(b, triangle_batches_.corners(x, b)); });
}

template <class Hinges>
void MidEdgeBending<Hinges>::compute_changes(const Coordinates& x, const Coordinates& dx, const Scratch& to,
                                             ThreadPool* pool) const {
  const double* phi = compute_rotation_changes(x, dx, to, pool);
  compute_moments(to.angles, phi, to.moments, pool, [&](int b) {
    return strain_change(hinges_.edges(b, triangle_batches_.corners(x, b)),
                         edges_of(triangle_batches_.corners(dx, b)));
  });
}

template <class Hinges>
Pack MidEdgeBending<Hinges>::own_moment(int batch, const double* m) const {
  Pack moment;
  for (int lane = 0; lane < Pack::kLanes; ++lane) {
    const auto& index = moment_index_[static_cast<std::size_t>(hinge_batches_.element(batch, lane))];
    moment.set(lane, m[index[0]] - m[index[1]]);
  }
  return moment;
}

template <class Hinges>
Pack MidEdgeBending<Hinges>::hinge_moment(int batch, const Scratch& at) const {
  Pack moment;
  for (int lane = 0; lane < Pack::kLanes; ++lane) {
    const auto& index = moment_index_[static_cast<std::size_t>(hinge_batches_.element(batch, lane))];
    moment.set(lane, 0.5 * (at.moments[index[0]] + at.moments[index[1]]));
  }
  if constexpr (Hinges::kOf == Of::position)
    moment -= load(at.slopes + Pack::kLanes * batch) * own_moment(batch, at.moments);
  return moment;
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_own_forces(VecX<double>& f, const double* m) const {
  double* own = f.data() + 3 * n_nodes_;
  const auto n_hinges = static_cast<std::size_t>(n_hinges_);
  for (std::size_t e = 0; e < n_hinges; ++e) own[e] -= m[moment_index_[e][0]] - m[moment_index_[e][1]];
  for (std::size_t e = n_hinges; e < edges_.size(); ++e) own[e] -= m[moment_index_[e][0]];
}

template <class Hinges>
double MidEdgeBending<Hinges>::energy(const Coordinates& x) const {
  Buffer buffer;
  const Scratch at = scratch(buffer);
  const double* phi = compute_rotations(x, at, nullptr);
  double twice_E = 0;
  for (int b = 0; b < triangle_batches_.n_batches(); ++b) {
    const Triangles& triangles = triangles_[static_cast<std::size_t>(b)];
    const PerEdge alpha = rotations(triangles, at.angles, phi,
                                    hinges_.strain(b, triangle_batches_.corners(x, b))),
                  m = moments(triangles, alpha);
    twice_E += sum(alpha[0] * m[0] + alpha[1] * m[1] + alpha[2] * m[2]);
  }
  return 0.5 * twice_E;
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_forces(const Coordinates& x, const Scratch& at, VecX<double>& f,
                                        ThreadPool* pool) const {
  hinge_batches_.add(f, at.corners, pool, [&](int b) {
    return detail::scaled_corners(-hinge_moment(b, at), hinges_.gradient(b, hinge_batches_.corners(x, b)));
  });
  if (curved_)
    triangle_batches_.add(f, at.corners, pool, [&](int b) {
      return corner_forces(tensions(triangles_[static_cast<std::size_t>(b)], moments_at(b, at.moments)),
                           hinges_.edges(b, triangle_batches_.corners(x, b)));
    });
  add_own_forces(f, at.moments);
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer,
                                       ThreadPool* pool) const {
  const Scratch now = scratch(buffer);
  compute_state(x, now, pool);
  add_forces(x, now, f, pool);
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_viscous_force(const Coordinates& x, const Coordinates& x_dot,
                                               VecX<double>& f, Buffer& buffer, ThreadPool* pool) const {
  const Scratch rate = scratch(buffer);
  compute_changes(x, x_dot, rate, pool);
  add_forces(x, rate, f, pool);
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_geometric_change(const Coordinates& x, const Coordinates& dx,
                                                  const Scratch& now, VecX<double>& f,
                                                  ThreadPool* pool) const {
  hinge_batches_.add(f, now.corners, pool, [&](int b) {
    const Corners corners = hinge_batches_.corners(x, b), change = hinge_batches_.corners(dx, b),
                  gradient = hinges_.gradient(b, corners);
    const Pack moment = -hinge_moment(b, now), turning = hinges_.turn(b, corners).curvature *
                                                         own_moment(b, now.moments) * dot(gradient, change);
    Corners force = detail::scaled_corners(moment, detail::hinge_gradient_change(corners, change));
    for (std::size_t c = 0; c < 4; ++c) force[c] += turning * gradient[c];
    return force;
  });
  if (curved_)
    triangle_batches_.add(f, now.corners, pool, [&](int b) {
      return corner_forces(tensions(triangles_[static_cast<std::size_t>(b)], moments_at(b, now.moments)),
                           edges_of(triangle_batches_.corners(dx, b)));
    });
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_derivative(const Coordinates& x, const Coordinates& dx, VecX<double>& f,
                                            Buffer& buffer, ThreadPool* pool) const {
  add_viscous_force(x, dx, f, buffer, pool);
  if constexpr (Hinges::kOf == Of::position) {
    const Scratch now = scratch(buffer);
    compute_state(x, now, pool);
    add_geometric_change(x, dx, now, f, pool);
  }
}

/// A triangle has 21 local coordinates: its corners (0 to 8), the opposite corners of the three neighbouring
/// triangles (9 to 17) and the own coordinates of its edges (18 to 20).
template <class Hinges>
struct MidEdgeBending<Hinges>::Stiffness {
  static constexpr int kCoordinates = 21;
  ElementMatrix<kCoordinates> element{{}, Eigen::Matrix<double, kCoordinates, kCoordinates>::Zero()};
  /// dalpha/dx: one row for each edge of the triangle.
  Eigen::Matrix<double, 3, kCoordinates> G = Eigen::Matrix<double, 3, kCoordinates>::Zero();
};

template <class Hinges>
void MidEdgeBending<Hinges>::add_edge(int t, int k, double moment, const Coordinates& x,
                                      Stiffness& to) const {
  const int n = static_cast<int>(n_nodes_), i = (k + 1) % 3, j = (k + 2) % 3;
  const auto corner = static_cast<std::size_t>(k), lane = static_cast<std::size_t>(t % Pack::kLanes);
  const int e = triangles_[static_cast<std::size_t>(t / Pack::kLanes)].edge[corner][lane];
  const ShellEdge& edge = edges_[static_cast<std::size_t>(e)];
  const bool left = edge.left == t;
  const int own = triangle_nodes_(k, t);
  int across = own;  // a boundary edge has no opposite corner; the terms of this corner are 0
  if (edge.inside()) {
    across =
        left ? triangle_nodes_(edge.right_corner, edge.right) : triangle_nodes_(edge.left_corner, edge.left);
    // Numbers of the hinge's corners a, b, c, d among the six corners of `Stiffness`.
    const std::array<int, 4> place{left ? i : j, left ? j : i, left ? k : 3 + k, left ? 3 + k : k};
    const int batch = e / Pack::kLanes, at = e % Pack::kLanes;
    const Corners now = hinge_batches_.corners(x, batch), gradient = hinges_.gradient(batch, now);
    double share = 0.5, bending = 0;  // dalpha/dtheta and d2alpha/dtheta2 with constant own coordinates
    if constexpr (Hinges::kOf == Of::position) {
      const FoldTurn<Pack> turn = hinges_.turn(batch, now);
      share -= (left ? 1 : -1) * turn.slope[at];
      bending -= (left ? 1 : -1) * turn.curvature[at];
    }
    for (std::size_t c = 0; c < 4; ++c)
      for (int axis = 0; axis < 3; ++axis) {
        to.G(k, 3 * place[c] + axis) += share * gradient[c][axis][at];
        if constexpr (Hinges::kOf == Of::position) {
          Corners unit;
          for (Vec3<Pack>& u : unit) u.setConstant(Pack(0.0));
          unit[c][axis] = 1.0;
          const Corners change = detail::hinge_gradient_change(now, unit);
          for (std::size_t r = 0; r < 4; ++r)
            for (int row = 0; row < 3; ++row)
              to.element.K(3 * place[r] + row, 3 * place[c] + axis) +=
                  moment *
                  (share * change[r][row][at] + bending * gradient[r][row][at] * gradient[c][axis][at]);
        }
      }
  }
  for (int axis = 0; axis < 3; ++axis) {
    to.element.index[static_cast<std::size_t>(3 * k + axis)] = own + axis * n;
    to.element.index[static_cast<std::size_t>(9 + 3 * k + axis)] = across + axis * n;
  }
  to.element.index[static_cast<std::size_t>(18 + k)] = 3 * n + e;
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_strain(const Triangles& triangles, int lane, const Edges<Pack>& edges,
                                        const PerEdge& tension, Stiffness& to) {
  for (int l = 0; l < 3; ++l) {
    const auto edge = static_cast<std::size_t>(l);
    const int end = 3 * ((l + 2) % 3), begin = 3 * ((l + 1) % 3);
    for (int axis = 0; axis < 3; ++axis) {
      for (int k = 0; k < 3; ++k) {
        const double slope = triangles.C[static_cast<std::size_t>(k)][edge][lane] * edges[edge][axis][lane];
        to.G(k, end + axis) += slope;
        to.G(k, begin + axis) -= slope;
      }
      if constexpr (Hinges::kOf == Of::position) {
        const double tau = tension[edge][lane];
        to.element.K(end + axis, end + axis) += tau;
        to.element.K(begin + axis, begin + axis) += tau;
        to.element.K(end + axis, begin + axis) -= tau;
        to.element.K(begin + axis, end + axis) -= tau;
      }
    }
  }
}

template <class Hinges>
typename MidEdgeBending<Hinges>::Stiffness MidEdgeBending<Hinges>::triangle_matrix(
    int t, const Coordinates& x, const double* angles, const double* phi, Terms terms) const {
  const int batch = t / Pack::kLanes, lane = t % Pack::kLanes;
  const Triangles& triangles = triangles_[static_cast<std::size_t>(batch)];
  const TriangleCorners corners = triangle_batches_.corners(x, batch);
  const PerEdge alpha = rotations(triangles, angles, phi, hinges_.strain(batch, corners)),
                m = terms == Terms::stiffness ? moments(triangles, alpha) : PerEdge{0.0, 0.0, 0.0};
  Stiffness stiffness;
  Mat3<double> Q;
  for (int k = 0; k < 3; ++k) {
    const auto corner = static_cast<std::size_t>(k);
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    Q(k, k) = triangles.Q_diagonal[corner][lane];
    Q(i, j) = Q(j, i) = triangles.Q_off_diagonal[corner][lane];
    stiffness.G(k, 18 + k) = triangles.side[corner][lane];
    add_edge(t, k, m[corner][lane], x, stiffness);
  }
  add_strain(triangles, lane, hinges_.edges(batch, corners), tensions(triangles, m), stiffness);
  stiffness.element.K += stiffness.G.transpose() * Q * stiffness.G;
  return stiffness;
}

template <class Hinges>
template <class Visit>
void MidEdgeBending<Hinges>::each_element(const Coordinates& x, Terms terms, Visit&& visit) const {
  Buffer buffer;
  const Scratch at = scratch(buffer);
  const double* phi = compute_rotations(x, at, nullptr);
  for (int t = 0; t < triangle_nodes_.cols(); ++t)
    visit(triangle_matrix(t, x, at.angles, phi, terms).element);
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_stiffness(const Coordinates& x,
                                           std::vector<Eigen::Triplet<double>>& K) const {
  add_triplets([&](auto&& visit) { each_element(x, Terms::stiffness, visit); }, K);
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_viscosity(const Coordinates& x,
                                           std::vector<Eigen::Triplet<double>>& V) const {
  add_triplets([&](auto&& visit) { each_element(x, Terms::viscosity, visit); }, V);
}

template <class Hinges>
double MidEdgeBending<Hinges>::frequency_bound(const Coordinates& x, const VecX<double>& M) const {
  return largest_element_frequency([&](auto&& visit) { each_element(x, Terms::stiffness, visit); }, M);
}

}  // namespace pliant
