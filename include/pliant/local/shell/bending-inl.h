#include <pliant/local/shell/bending.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/SparseCholesky>

#include <pliant/local/solid/element_matrix.h>
#include <pliant/math/scalar/dual.h>

namespace pliant {

namespace {

constexpr int kBatchesInRange = 256;
/// Angles of less than this are the rounding of a flat mesh.
constexpr double kFlat = 1e-12;

/// Q of a triangle with the edges e.
Mat3<double> bending_stiffness(const Edges<double>& e, const Sheet& sheet) {
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

/// Corners a, b, c, d of the edges between two triangles.
Eigen::Matrix4Xi hinge_corners(const ShellMesh& mesh, const std::vector<ShellEdge>& edges) {
  const auto n = std::count_if(edges.begin(), edges.end(), [](const ShellEdge& e) { return e.inside(); });
  Eigen::Matrix4Xi corners(4, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ShellEdge& edge = edges[static_cast<std::size_t>(i)];
    corners.col(i) << edge.a, edge.b, mesh.triangles()(edge.left_corner, edge.left),
        mesh.triangles()(edge.right_corner, edge.right);
  }
  return corners;
}

Pack gather(const double* from, const std::array<int, Pack::kLanes>& at) {
  return {from[at[0]], from[at[1]], from[at[2]], from[at[3]]};
}

HingeCorners<Pack> times(const Pack& factor, const HingeCorners<Pack>& a) {
  return {factor * a[0], factor * a[1], factor * a[2], factor * a[3]};
}

/// d(dtheta/dx) along dx.
HingeCorners<Pack> gradient_change(const HingeCorners<Pack>& x, const HingeCorners<Pack>& dx) {
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

}  // namespace

template <class Hinges>
MidEdgeBending<Hinges>::MidEdgeBending(const ShellMesh& mesh, const Sheet& sheet, double area_density)
    : n_nodes_(mesh.n_nodes()),
      corners_(mesh.triangles()),
      edges_(shell_edges(mesh)),
      batches_(hinge_corners(mesh, edges_), mesh.n_nodes()),
      corner_batches_(mesh.triangles(), mesh.n_nodes()),
      hinges_(batches_, corner_batches_, mesh.X().reshaped()),
      triangles_(static_cast<std::size_t>((mesh.n_triangles() + Pack::kLanes - 1) / Pack::kLanes)),
      moment_places_(edges_.size()),
      own_inertia_(VecX<double>::Zero(static_cast<Eigen::Index>(edges_.size()))) {
  sheet.check();
  if (!(area_density > 0) || !std::isfinite(area_density))
    throw std::invalid_argument("the mass of a sheet per area must be positive");
  n_inside_ = batches_.n_elements();
  const int n_triangles = static_cast<int>(mesh.n_triangles());
  for (int t = 0; t < Pack::kLanes * static_cast<int>(triangles_.size()); ++t) {
    Triangles& of = triangles_[static_cast<std::size_t>(t / Pack::kLanes)];
    const bool padding = t >= n_triangles;
    const Mat3<double> Q = bending_stiffness(edges_of(mesh, std::min(t, n_triangles - 1)), sheet);
    for (int k = 0; k < 3; ++k) {
      const auto corner = static_cast<std::size_t>(k);
      of.Q_diagonal[corner].set(t % Pack::kLanes, padding ? 0 : Q(k, k));
      of.Q_off[corner].set(t % Pack::kLanes, padding ? 0 : Q((k + 1) % 3, (k + 2) % 3));
      of.side[corner].set(t % Pack::kLanes, 1);
      of.edge[corner][static_cast<std::size_t>(t % Pack::kLanes)] = 0;
      of.angle[corner][static_cast<std::size_t>(t % Pack::kLanes)] = 0;
    }
  }
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const ShellEdge& edge = edges_[e];
    auto attach = [&](int t, int k, double side) {
      Triangles& of = triangles_[static_cast<std::size_t>(t / Pack::kLanes)];
      const auto corner = static_cast<std::size_t>(k), lane = static_cast<std::size_t>(t % Pack::kLanes);
      of.side[corner].set(t % Pack::kLanes, side);
      of.edge[corner][lane] = static_cast<int>(e);
      of.angle[corner][lane] = edge.inside() ? static_cast<int>(e) : n_angles() - 1;  // the last stays 0
      own_inertia_[static_cast<Eigen::Index>(e)] +=
          area_density * sheet.thickness * sheet.thickness / 12 * mesh.area(t) / 3;
      return (t / Pack::kLanes * 3 + k) * Pack::kLanes + t % Pack::kLanes;
    };
    moment_places_[e][0] = attach(edge.left, edge.left_corner, 1);
    if (edge.inside()) moment_places_[e][1] = attach(edge.right, edge.right_corner, -1);
  }
  set_coupling(mesh);
}

/// C, from the curvature at rest, b = 1/A sum_k alpha_k |e_k| n_k n_k^T with the normals at the edges where
/// they make the least of 1/2 sum alpha Q alpha. As a triangle is strained by eps, alpha_k measures along an
/// edge that moves:
///   kappa = 1/A sum_k (dalpha_k + alpha_k n_k.eps n_k) |e_k| n_k n_k^T - (b eps + eps b)/2.
template <class Hinges>
void MidEdgeBending<Hinges>::set_coupling(const ShellMesh& mesh) {
  std::vector<double> angles(static_cast<std::size_t>(n_angles()), 0.0), m(n_moments());
  const VecX<double> X = mesh.X().reshaped();
  for (int b = 0; b < batches_.n_batches(); ++b) {
    const math::SinCos<Pack> theta = hinge_sin_cos(batches_.corners(X, b));
    for (int lane = 0; lane < Pack::kLanes; ++lane)
      angles[static_cast<std::size_t>(Pack::kLanes * b + lane)] =
          std::atan2(theta.sin[lane], theta.cos[lane]);
  }
  const Three none{0.0, 0.0, 0.0};
  for (Triangles& of : triangles_) of.C = {none, none, none};
  curved_ = std::any_of(angles.begin(), angles.end(), [](double a) { return std::abs(a) > kFlat; });
  if (!curved_) return;
  VecX<double> phi = VecX<double>::Zero(own_inertia_.size()),
               f = VecX<double>::Zero(3 * n_nodes_ + phi.size());
  fill_moments(angles.data(), phi.data(), m.data(), nullptr, [&](int) { return none; });
  add_own_forces(f, m.data());
  if (f.norm() > 0) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int t = 0; t < corners_.cols(); ++t) {
      const Triangles& of = triangles_[static_cast<std::size_t>(t / Pack::kLanes)];
      const auto lane = static_cast<std::size_t>(t % Pack::kLanes);
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t l = 0; l < 3; ++l) {
          const Pack& Q = k == l ? of.Q_diagonal[k] : of.Q_off[3 - k - l];
          entries.emplace_back(of.edge[k][lane], of.edge[l][lane],
                               (of.side[k] * of.side[l] * Q)[t % Pack::kLanes]);
        }
    }
    Eigen::SparseMatrix<double> K(phi.size(), phi.size());
    K.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(K);
    phi = factor.solve(f.tail(phi.size()));
  }
  for (int t = 0; t < Pack::kLanes * static_cast<int>(triangles_.size()); ++t) {
    Triangles& of = triangles_[static_cast<std::size_t>(t / Pack::kLanes)];
    const int lane = t % Pack::kLanes;
    const Edges<double> e = edges_of(mesh, std::min(t, static_cast<int>(corners_.cols()) - 1));
    const std::array<Mat3<double>, 3> B = edge_strains(e);
    const Three rest = turns(of, angles.data(), phi.data(), none);
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
      // Its parts along n_k n_k^T, by -(e_i e_j + e_j e_i)/(8 A^2), which is dual to t_k t_k.
      for (std::size_t k = 0; k < 3; ++k)
        of.C[k][l].set(lane, -e[k].norm() * e[(k + 1) % 3].dot(kappa * e[(k + 2) % 3]) / (4 * area));
    }
  }
}

template <class Hinges>
typename MidEdgeBending<Hinges>::Places MidEdgeBending<Hinges>::places(Buffer& buffer, int copies) const {
  const std::size_t corners = std::max(batches_.buffer_size(), corner_batches_.buffer_size()),
                    angles = static_cast<std::size_t>(copies * n_angles());
  buffer.numbers.resize(corners + angles + static_cast<std::size_t>(copies) * n_moments());
  double* numbers = buffer.numbers.data();
  return {numbers, numbers + corners, numbers + corners + angles};
}

template <class Hinges>
typename MidEdgeBending<Hinges>::Three MidEdgeBending<Hinges>::turns(const Triangles& of,
                                                                     const double* angles, const double* phi,
                                                                     const Three& q) {
  Three alpha;
  for (std::size_t k = 0; k < 3; ++k)
    alpha[k] = 0.5 * gather(angles, of.angle[k]) + of.side[k] * gather(phi, of.edge[k]) + of.C[k][0] * q[0] +
               of.C[k][1] * q[1] + of.C[k][2] * q[2];
  return alpha;
}

template <class Hinges>
typename MidEdgeBending<Hinges>::Three MidEdgeBending<Hinges>::tensions(const Triangles& of, const Three& m) {
  Three tau;
  for (std::size_t l = 0; l < 3; ++l) tau[l] = of.C[0][l] * m[0] + of.C[1][l] * m[1] + of.C[2][l] * m[2];
  return tau;
}

template <class Hinges>
typename MidEdgeBending<Hinges>::Three MidEdgeBending<Hinges>::moments_at(int batch, const double* m) const {
  const double* from = m + 3 * Pack::kLanes * batch;
  return {load(from), load(from + Pack::kLanes), load(from + 2 * Pack::kLanes)};
}

template <class Hinges>
typename MidEdgeBending<Hinges>::Three MidEdgeBending<Hinges>::moments(const Triangles& of,
                                                                       const Three& alpha) {
  Three m;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    m[k] = of.Q_diagonal[k] * alpha[k] + of.Q_off[j] * alpha[i] + of.Q_off[i] * alpha[j];
  }
  return m;
}

template <class Hinges>
template <class F>
void MidEdgeBending<Hinges>::fill_angles(double* angles, ThreadPool* pool, F&& f) const {
  angles[n_angles() - 1] = 0;
  for_ranges(batches_.n_batches(), kBatchesInRange, pool, [&](int first, int last) {
    for (int b = first; b < last; ++b) store(f(b), angles + Pack::kLanes * b);
  });
}

template <class Hinges>
template <class F>
void MidEdgeBending<Hinges>::fill_moments(const double* angles, const double* phi, double* to,
                                          ThreadPool* pool, F&& strain) const {
  for_ranges(static_cast<int>(triangles_.size()), kBatchesInRange, pool, [&](int first, int last) {
    for (int b = first; b < last; ++b) {
      const Triangles& of = triangles_[static_cast<std::size_t>(b)];
      const Three m = moments(of, turns(of, angles, phi, strain(b)));
      for (int k = 0; k < 3; ++k) store(m[static_cast<std::size_t>(k)], to + (3 * b + k) * Pack::kLanes);
    }
  });
}

template <class Hinges>
Pack MidEdgeBending<Hinges>::hinge_moment(int batch, const double* m) const {
  Pack both;
  for (int lane = 0; lane < Pack::kLanes; ++lane) {
    const auto& at = moment_places_[static_cast<std::size_t>(batches_.element(batch, lane))];
    both.set(lane, 0.5 * (m[at[0]] + m[at[1]]));
  }
  return both;
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_own_forces(VecX<double>& f, const double* m) const {
  double* own = f.data() + 3 * n_nodes_;
  const auto n_inside = static_cast<std::size_t>(n_inside_);
  for (std::size_t e = 0; e < n_inside; ++e) own[e] -= m[moment_places_[e][0]] - m[moment_places_[e][1]];
  for (std::size_t e = n_inside; e < edges_.size(); ++e) own[e] -= m[moment_places_[e][0]];
}

template <class Hinges>
double MidEdgeBending<Hinges>::energy(const Coordinates& x) const {
  std::vector<double> angles(static_cast<std::size_t>(n_angles()));
  fill_angles(angles.data(), nullptr, [&](int b) { return hinges_.angle(b, batches_.corners(x, b)); });
  double twice = 0;
  for (int b = 0; b < corner_batches_.n_batches(); ++b) {
    const Triangles& of = triangles_[static_cast<std::size_t>(b)];
    const Three alpha = turns(of, angles.data(), x.data() + 3 * n_nodes_,
                              hinges_.strain(b, corner_batches_.corners(x, b))),
                m = moments(of, alpha);
    twice += sum(alpha[0] * m[0] + alpha[1] * m[1] + alpha[2] * m[2]);
  }
  return 0.5 * twice;
}

template <class Hinges>
void MidEdgeBending<Hinges>::push(const Coordinates& x, const double* m, VecX<double>& f, double* corners,
                                  ThreadPool* pool) const {
  batches_.add(f, corners, pool, [&](int b) {
    return times(-hinge_moment(b, m), hinges_.gradient(b, batches_.corners(x, b)));
  });
  if (curved_)
    corner_batches_.add(f, corners, pool, [&](int b) {
      return corner_forces(tensions(triangles_[static_cast<std::size_t>(b)], moments_at(b, m)),
                           hinges_.edges(b, corner_batches_.corners(x, b)));
    });
  add_own_forces(f, m);
}

template <class Hinges>
void MidEdgeBending<Hinges>::fill_changes(const Coordinates& x, const Coordinates& dx, double* angles,
                                          double* m, ThreadPool* pool) const {
  fill_angles(angles, pool, [&](int b) {
    return dot(hinges_.gradient(b, batches_.corners(x, b)), batches_.corners(dx, b));
  });
  fill_moments(angles, dx.data() + 3 * n_nodes_, m, pool, [&](int b) {
    return strain_change(hinges_.edges(b, corner_batches_.corners(x, b)),
                         edges_of(corner_batches_.corners(dx, b)));
  });
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer,
                                       ThreadPool* pool) const {
  const Places at = places(buffer, 1);
  fill_angles(at.angles, pool, [&](int b) { return hinges_.angle(b, batches_.corners(x, b)); });
  fill_moments(at.angles, x.data() + 3 * n_nodes_, at.moments, pool,
               [&](int b) { return hinges_.strain(b, corner_batches_.corners(x, b)); });
  push(x, at.moments, f, at.corners, pool);
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_viscous_force(const Coordinates& x, const Coordinates& x_dot,
                                               VecX<double>& f, Buffer& buffer, ThreadPool* pool) const {
  const Places at = places(buffer, 1);
  fill_changes(x, x_dot, at.angles, at.moments, pool);
  push(x, at.moments, f, at.corners, pool);
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_derivative(const Coordinates& x, const Coordinates& dx, VecX<double>& f,
                                            Buffer& buffer, ThreadPool* pool) const {
  add_viscous_force(x, dx, f, buffer, pool);
  if constexpr (Hinges::kOf == Of::position) {
    // What the moments push turns with the nodes.
    const Places at = places(buffer, 1);
    fill_angles(at.angles, pool, [&](int b) { return hinges_.angle(b, batches_.corners(x, b)); });
    fill_moments(at.angles, x.data() + 3 * n_nodes_, at.moments, pool,
                 [&](int b) { return hinges_.strain(b, corner_batches_.corners(x, b)); });
    batches_.add(f, at.corners, pool, [&](int b) {
      return times(-hinge_moment(b, at.moments),
                   gradient_change(batches_.corners(x, b), batches_.corners(dx, b)));
    });
    if (curved_)
      corner_batches_.add(f, at.corners, pool, [&](int b) {
        return corner_forces(tensions(triangles_[static_cast<std::size_t>(b)], moments_at(b, at.moments)),
                             edges_of(corner_batches_.corners(dx, b)));
      });
  }
}

/// A triangle's coordinates: its corners, the corners across its edges, phi of its edges.
template <class Hinges>
template <class Visit>
void MidEdgeBending<Hinges>::each_element(const Coordinates& x, Visit&& visit) const {
  constexpr int kCoordinates = 21;
  std::vector<double> angles(static_cast<std::size_t>(n_angles()));
  fill_angles(angles.data(), nullptr, [&](int b) { return hinges_.angle(b, batches_.corners(x, b)); });
  const int n = static_cast<int>(n_nodes_);
  for (int t = 0; t < corners_.cols(); ++t) {
    const auto batch = static_cast<std::size_t>(t / Pack::kLanes);
    const int lane = t % Pack::kLanes;
    const Triangles& of = triangles_[batch];
    const int b = static_cast<int>(batch);
    const TriangleCorners at_corners = corner_batches_.corners(x, b);
    const Edges<Pack> along = hinges_.edges(b, at_corners);
    const Three alpha = turns(of, angles.data(), x.data() + 3 * n_nodes_, hinges_.strain(b, at_corners)),
                m = moments(of, alpha), tau = tensions(of, m);
    ElementMatrix<kCoordinates> element{{}, Eigen::Matrix<double, kCoordinates, kCoordinates>::Zero()};
    Eigen::Matrix<double, 3, kCoordinates> G = Eigen::Matrix<double, 3, kCoordinates>::Zero();
    Mat3<double> Q;
    for (int k = 0; k < 3; ++k) {
      const auto corner = static_cast<std::size_t>(k);
      const int i = (k + 1) % 3, j = (k + 2) % 3, e = of.edge[corner][static_cast<std::size_t>(lane)];
      Q(k, k) = of.Q_diagonal[corner][lane];
      Q(i, j) = Q(j, i) = of.Q_off[corner][lane];
      G(k, 18 + k) = of.side[corner][lane];
      const ShellEdge& edge = edges_[static_cast<std::size_t>(e)];
      const bool left = edge.left == t;
      const int own = corners_(k, t);
      int across = own;  // no one stands across a boundary: nothing is entered there
      if (edge.inside()) {
        across = left ? corners_(edge.right_corner, edge.right) : corners_(edge.left_corner, edge.left);
        // The edge's own corners a, b, c, d among those of the triangle.
        const std::array<int, 4> place{left ? i : j, left ? j : i, left ? k : 3 + k, left ? 3 + k : k};
        const int hinge = e / Pack::kLanes, at = e % Pack::kLanes;
        const Corners now = batches_.corners(x, hinge), gradient = hinges_.gradient(hinge, now);
        for (std::size_t c = 0; c < 4; ++c)
          for (int axis = 0; axis < 3; ++axis) {
            G(k, 3 * place[c] + axis) += 0.5 * gradient[c][axis][at];
            if constexpr (Hinges::kOf == Of::position) {
              Corners unit;
              for (Vec3<Pack>& u : unit) u.setConstant(Pack(0.0));
              unit[c][axis] = 1.0;
              const Corners bend = gradient_change(now, unit);
              for (std::size_t r = 0; r < 4; ++r)
                for (int row = 0; row < 3; ++row)
                  element.K(3 * place[r] + row, 3 * place[c] + axis) +=
                      0.5 * m[corner][lane] * bend[r][row][at];
            }
          }
      }
      for (int axis = 0; axis < 3; ++axis) {
        element.at[static_cast<std::size_t>(3 * k + axis)] = own + axis * n;
        element.at[static_cast<std::size_t>(9 + 3 * k + axis)] = across + axis * n;
      }
      element.at[static_cast<std::size_t>(18 + k)] = 3 * n + e;
    }
    for (int l = 0; l < 3; ++l) {
      const auto edge = static_cast<std::size_t>(l);
      const int to = 3 * ((l + 2) % 3), from = 3 * ((l + 1) % 3);
      for (int axis = 0; axis < 3; ++axis) {
        for (int k = 0; k < 3; ++k) {
          const double slope = of.C[static_cast<std::size_t>(k)][edge][lane] * along[edge][axis][lane];
          G(k, to + axis) += slope;
          G(k, from + axis) -= slope;
        }
        if constexpr (Hinges::kOf == Of::position) {
          const double tension = tau[edge][lane];
          element.K(to + axis, to + axis) += tension;
          element.K(from + axis, from + axis) += tension;
          element.K(to + axis, from + axis) -= tension;
          element.K(from + axis, to + axis) -= tension;
        }
      }
    }
    element.K += G.transpose() * Q * G;
    visit(element);
  }
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_stiffness(const Coordinates& x,
                                           std::vector<Eigen::Triplet<double>>& K) const {
  add_triplets([&](auto&& visit) { each_element(x, visit); }, K);
}

template <class Hinges>
double MidEdgeBending<Hinges>::frequency_bound(const Coordinates& x, const VecX<double>& M) const {
  return largest_of_elements([&](auto&& visit) { each_element(x, visit); }, M);
}

template class MidEdgeBending<LinearHinges>;
template class MidEdgeBending<FoldingHinges>;

}  // namespace pliant
