#include <pliant/local/bending.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <pliant/local/element_matrix.h>
#include <pliant/math/dual.h>

namespace pliant {

namespace {

constexpr int kBatchesInRange = 256;

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

Pack dot(const HingeCorners<Pack>& a, const HingeCorners<Pack>& b) {
  return a[0].dot(b[0]) + a[1].dot(b[1]) + a[2].dot(b[2]) + a[3].dot(b[3]);
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

LinearHinges::LinearHinges(const ElementBatches<4>& batches, const VecX<double>& X) {
  for (int b = 0; b < batches.n_batches(); ++b) gradients_.push_back(hinge_gradient(batches.corners(X, b)));
}

Pack LinearHinges::angle(int batch, const HingeCorners<Pack>& d) const {
  return dot(gradients_[static_cast<std::size_t>(batch)], d);
}

FoldingHinges::FoldingHinges(const ElementBatches<4>& batches, const VecX<double>& X) {
  for (int b = 0; b < batches.n_batches(); ++b) rest_.push_back(hinge_sin_cos(batches.corners(X, b)));
}

Pack FoldingHinges::angle(int batch, const HingeCorners<Pack>& x) const {
  const math::SinCos<Pack>& rest = rest_[static_cast<std::size_t>(batch)];
  const math::SinCos<Pack> now = hinge_sin_cos(x);
  // Of the difference, so that half a turn from rest is what must not be reached.
  const Pack s = now.sin * rest.cos - now.cos * rest.sin, c = now.cos * rest.cos + now.sin * rest.sin;
  return {std::atan2(s[0], c[0]), std::atan2(s[1], c[1]), std::atan2(s[2], c[2]), std::atan2(s[3], c[3])};
}

template <class Hinges>
MidEdgeBending<Hinges>::MidEdgeBending(const ShellMesh& mesh, const Sheet& sheet, double area_density)
    : n_nodes_(mesh.n_nodes()),
      corners_(mesh.triangles()),
      edges_(shell_edges(mesh)),
      batches_(hinge_corners(mesh, edges_), mesh.n_nodes()),
      hinges_(batches_, mesh.X().reshaped()),
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
}

template <class Hinges>
typename MidEdgeBending<Hinges>::Places MidEdgeBending<Hinges>::places(Buffer& buffer, int copies) const {
  const std::size_t corners = batches_.buffer_size(), angles = static_cast<std::size_t>(copies * n_angles());
  buffer.numbers.resize(corners + angles + static_cast<std::size_t>(copies) * n_moments());
  double* numbers = buffer.numbers.data();
  return {numbers, numbers + corners, numbers + corners + angles};
}

/// alpha of a batch of triangles.
template <class Hinges>
typename MidEdgeBending<Hinges>::Three MidEdgeBending<Hinges>::turns(const Triangles& of,
                                                                     const double* angles,
                                                                     const double* phi) const {
  Three alpha;
  for (std::size_t k = 0; k < 3; ++k)
    alpha[k] = 0.5 * gather(angles, of.angle[k]) + of.side[k] * gather(phi, of.edge[k]);
  return alpha;
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
void MidEdgeBending<Hinges>::fill_moments(const double* angles, const double* phi, double* to,
                                          ThreadPool* pool) const {
  for_ranges(static_cast<int>(triangles_.size()), kBatchesInRange, pool, [&](int first, int last) {
    for (int b = first; b < last; ++b) {
      const Triangles& of = triangles_[static_cast<std::size_t>(b)];
      const Three m = moments(of, turns(of, angles, phi));
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
double MidEdgeBending<Hinges>::energy(const VecX<double>& x) const {
  std::vector<double> angles(static_cast<std::size_t>(n_angles()));
  fill_angles(angles.data(), nullptr, [&](int b) { return hinges_.angle(b, batches_.corners(x, b)); });
  double twice = 0;
  for (const Triangles& of : triangles_) {
    const Three alpha = turns(of, angles.data(), x.data() + 3 * n_nodes_), m = moments(of, alpha);
    twice += sum(alpha[0] * m[0] + alpha[1] * m[1] + alpha[2] * m[2]);
  }
  return 0.5 * twice;
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_force(const VecX<double>& x, VecX<double>& f, Buffer& buffer,
                                       ThreadPool* pool) const {
  const Places at = places(buffer, 1);
  fill_angles(at.angles, pool, [&](int b) { return hinges_.angle(b, batches_.corners(x, b)); });
  fill_moments(at.angles, x.data() + 3 * n_nodes_, at.moments, pool);
  batches_.add(f, at.corners, pool, [&](int b) {
    return times(-hinge_moment(b, at.moments), hinges_.gradient(b, batches_.corners(x, b)));
  });
  add_own_forces(f, at.moments);
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_derivative(const VecX<double>& x, const VecX<double>& dx, VecX<double>& f,
                                            Buffer& buffer, ThreadPool* pool) const {
  if constexpr (Hinges::kOf == Of::displacement) {
    add_force(dx, f, buffer, pool);
  } else {
    const Places at = places(buffer, 2);
    double *d_angles = at.angles + n_angles(), *d_moments = at.moments + n_moments();
    fill_angles(at.angles, pool, [&](int b) { return hinges_.angle(b, batches_.corners(x, b)); });
    fill_angles(d_angles, pool, [&](int b) {
      return dot(hinges_.gradient(b, batches_.corners(x, b)), batches_.corners(dx, b));
    });
    fill_moments(at.angles, x.data() + 3 * n_nodes_, at.moments, pool);
    fill_moments(d_angles, dx.data() + 3 * n_nodes_, d_moments, pool);
    batches_.add(f, at.corners, pool, [&](int b) {
      const Corners now = batches_.corners(x, b);
      Corners df = times(-hinge_moment(b, d_moments), hinges_.gradient(b, now));
      const Corners turned =
          times(-hinge_moment(b, at.moments), gradient_change(now, batches_.corners(dx, b)));
      for (std::size_t k = 0; k < 4; ++k) df[k] += turned[k];
      return df;
    });
    add_own_forces(f, d_moments);
  }
}

/// A triangle's coordinates: its corners, the corners across its edges, phi of its edges.
template <class Hinges>
template <class Visit>
void MidEdgeBending<Hinges>::each_element(const VecX<double>& x, Visit&& visit) const {
  constexpr int kCoordinates = 21;
  std::vector<double> angles(static_cast<std::size_t>(n_angles()));
  fill_angles(angles.data(), nullptr, [&](int b) { return hinges_.angle(b, batches_.corners(x, b)); });
  const int n = static_cast<int>(n_nodes_);
  for (int t = 0; t < corners_.cols(); ++t) {
    const auto batch = static_cast<std::size_t>(t / Pack::kLanes);
    const int lane = t % Pack::kLanes;
    const Triangles& of = triangles_[batch];
    const Three alpha = turns(of, angles.data(), x.data() + 3 * n_nodes_), m = moments(of, alpha);
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
            G(k, 3 * place[c] + axis) = 0.5 * gradient[c][axis][at];
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
    element.K += G.transpose() * Q * G;
    visit(element);
  }
}

template <class Hinges>
void MidEdgeBending<Hinges>::add_stiffness(const VecX<double>& x,
                                           std::vector<Eigen::Triplet<double>>& K) const {
  add_triplets([&](auto&& visit) { each_element(x, visit); }, K);
}

template <class Hinges>
double MidEdgeBending<Hinges>::frequency_bound(const VecX<double>& x, const VecX<double>& M) const {
  return largest_of_elements([&](auto&& visit) { each_element(x, visit); }, M);
}

template class MidEdgeBending<LinearHinges>;
template class MidEdgeBending<FoldingHinges>;

}  // namespace pliant
