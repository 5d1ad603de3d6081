// Function bodies of loaded_membrane.h. add_force() evaluates -K q_d of Eq. (11), triangle by triangle.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

#include <pliant/local/shell/loaded_membrane.h>
#include <pliant/local/solid/element_matrix.h>
#include <pliant/math/header_only.h>

namespace pliant {

namespace detail {

/// Returns the triangles of a parameter mesh. Throws std::invalid_argument if a triangle refers to an unknown
/// node, or if uv does not have one column for each corner.
inline const Eigen::Matrix3Xi& checked_parameter_triangles(const ParameterMesh& mesh) {
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k)
      if (mesh.triangles(k, t) < 0 || mesh.triangles(k, t) >= mesh.n_nodes)
        throw std::invalid_argument("triangle " + std::to_string(t) +
                                    " of the parameter mesh refers to node " +
                                    std::to_string(mesh.triangles(k, t)) + "; the mesh has nodes 0 to " +
                                    std::to_string(mesh.n_nodes - 1));
  if (mesh.uv.cols() != 3 * mesh.triangles.cols())
    throw std::invalid_argument("the parameter mesh has " + std::to_string(mesh.uv.cols()) +
                                " pairs (u, v) for " + std::to_string(mesh.triangles.cols()) +
                                " triangles; it needs one for each corner");
  return mesh.triangles;
}

}  // namespace detail

PLIANT_INLINE LoadedMembrane::LoadedMembrane(const Eigen::Matrix3Xi& triangles, Eigen::Index n_nodes,
                                             const Load& load)
    : batches_(triangles, n_nodes), triangles_(static_cast<std::size_t>(batches_.n_batches())) {
  if (!(load.w0 >= 0) || !(load.w1 >= 0) || !std::isfinite(load.w0 + load.w1))
    throw std::invalid_argument("the weights of a loaded membrane are w0 = " + std::to_string(load.w0) +
                                " and w1 = " + std::to_string(load.w1) +
                                "; they must be finite and not negative");
}

PLIANT_INLINE LoadedMembrane::LoadedMembrane(const ParameterMesh& mesh, const Load& load)
    : LoadedMembrane(detail::checked_parameter_triangles(mesh), mesh.n_nodes, load) {
  for (int b = 0; b < batches_.n_batches(); ++b)
    for (int lane = 0; lane < Pack::kLanes; ++lane) {
      const int t = batches_.element(b, lane);
      auto corner = [&](int k) { return Vec3<double>(mesh.uv(0, 3 * t + k), mesh.uv(1, 3 * t + k), 0); };
      const Edges<double> e = edges_of<double>({corner(0), corner(1), corner(2)});
      if (!(e[0].cross(e[1]).norm() > 0))
        throw std::invalid_argument("triangle " + std::to_string(t) + " of the parameter mesh has no area");
      set_triangle(b, lane, e, load);
    }
}

PLIANT_INLINE LoadedMembrane::LoadedMembrane(const ShellMesh& mesh, const Load& load)
    : LoadedMembrane(mesh.triangles(), mesh.n_nodes(), load) {
  for (int b = 0; b < batches_.n_batches(); ++b)
    for (int lane = 0; lane < Pack::kLanes; ++lane)
      set_triangle(b, lane, edges_of(mesh, batches_.element(b, lane)), load);
}

PLIANT_INLINE void LoadedMembrane::set_triangle(int b, int lane, const Edges<double>& e, const Load& load) {
  Triangles& triangles = triangles_[static_cast<std::size_t>(b)];
  const double twice_area = e[0].cross(e[1]).norm();
  for (std::size_t k = 0; k < 3; ++k)
    triangles.spring[k].set(lane, -0.5 * load.w1 * e[(k + 1) % 3].dot(e[(k + 2) % 3]) / twice_area);
  const double share = load.w0 * twice_area / 24;
  const bool lumped = load.size == Load::Size::lumped;
  triangles.diagonal.set(lane, lumped ? 4 * share : share);
  triangles.uniform.set(lane, lumped ? 0 : share);
}

PLIANT_INLINE LoadedMembrane::Corners LoadedMembrane::K_times(int batch, const Corners& d) const {
  const Triangles& triangles = triangles_[static_cast<std::size_t>(batch)];
  const Vec3<Pack> all = triangles.uniform * (d[0] + d[1] + d[2]);
  const Corners springs = corner_forces(triangles.spring, edges_of(d));
  Corners K_d;
  for (std::size_t k = 0; k < 3; ++k) K_d[k] = all + triangles.diagonal * d[k] - springs[k];
  return K_d;
}

PLIANT_INLINE double LoadedMembrane::energy(const Coordinates& x) const {
  double twice_E = 0;
  for (int b = 0; b < batches_.n_batches(); ++b) {
    const Corners d = batches_.corners(x, b), K_d = K_times(b, d);
    const Pack work = d[0].dot(K_d[0]) + d[1].dot(K_d[1]) + d[2].dot(K_d[2]);
    for (int lane = 0; lane < batches_.lanes(b); ++lane) twice_E += work[lane];
  }
  return 0.5 * twice_E;
}

PLIANT_INLINE void LoadedMembrane::add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer,
                                             ThreadPool* pool) const {
  buffer.numbers.resize(batches_.buffer_size());
  batches_.add(f, buffer.numbers.data(), pool, [&](int b) {
    Corners force = K_times(b, batches_.corners(x, b));
    for (Vec3<Pack>& f_k : force) f_k = -f_k;
    return force;
  });
}

PLIANT_INLINE void LoadedMembrane::add_derivative(const Coordinates&, const Coordinates& dx, VecX<double>& f,
                                                  Buffer& buffer, ThreadPool* pool) const {
  add_force(dx, f, buffer, pool);
}

template <class Visit>
void LoadedMembrane::each_element(Visit&& visit) const {
  for (int b = 0; b < batches_.n_batches(); ++b) {
    const Triangles& triangles = triangles_[static_cast<std::size_t>(b)];
    for (int lane = 0; lane < batches_.lanes(b); ++lane) {
      Mat3<double> k = Mat3<double>::Constant(triangles.uniform[lane]);
      k.diagonal().array() += triangles.diagonal[lane];
      for (int edge = 0; edge < 3; ++edge) {
        const int i = (edge + 1) % 3, j = (edge + 2) % 3;
        const double spring = triangles.spring[static_cast<std::size_t>(edge)][lane];
        k(i, i) += spring;
        k(j, j) += spring;
        k(i, j) -= spring;
        k(j, i) -= spring;
      }
      ElementMatrix<9> element{batches_.coordinates(b, lane), Eigen::Matrix<double, 9, 9>::Zero()};
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) element.K.block<3, 3>(3 * i, 3 * j).diagonal().setConstant(k(i, j));
      visit(element);
    }
  }
}

PLIANT_INLINE void LoadedMembrane::add_stiffness(const Coordinates&,
                                                 std::vector<Eigen::Triplet<double>>& K) const {
  add_triplets([&](auto&& visit) { each_element(visit); }, K);
}

PLIANT_INLINE double LoadedMembrane::frequency_bound(const Coordinates&, const VecX<double>& M) const {
  return largest_element_frequency([&](auto&& visit) { each_element(visit); }, M);
}

}  // namespace pliant
