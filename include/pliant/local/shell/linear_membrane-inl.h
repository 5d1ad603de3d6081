// Function bodies of linear_membrane.h. add_force() evaluates -K q_d of Eq. (11), triangle by triangle.
#pragma once

#include <pliant/local/shell/linear_membrane.h>
#include <pliant/local/solid/element_matrix.h>
#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE LinearMembrane::LinearMembrane(const ShellMesh& mesh, const Sheet& sheet)
    : batches_(mesh.triangles(), mesh.n_nodes()), triangles_(static_cast<std::size_t>(batches_.n_batches())) {
  sheet.check();
  for (int b = 0; b < batches_.n_batches(); ++b)
    for (int lane = 0; lane < Pack::kLanes; ++lane) {
      Triangles& triangles = triangles_[static_cast<std::size_t>(b)];
      const Edges<double> e = edges_of(mesh, batches_.element(b, lane));
      const Mat3<double> S = edge_stiffness(e, sheet);
      const Vec3<double> root = S.diagonal().cwiseSqrt();
      auto normalized = [&](int k, int l) {
        return root[k] * root[l] > 0 ? S(k, l) / (root[k] * root[l]) : 0.0;
      };
      for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i) {
          const auto edge = static_cast<std::size_t>(k);
          triangles.e[edge][i].set(lane, root[k] * e[edge][i]);
        }
      triangles.s01.set(lane, normalized(0, 1));
      triangles.s12.set(lane, normalized(1, 2));
      triangles.s20.set(lane, normalized(2, 0));
    }
}

PLIANT_INLINE double LinearMembrane::energy(const Coordinates& x) const {
  double twice_E = 0;
  for (int b = 0; b < batches_.n_batches(); ++b) {
    const Triangles& triangles = triangles_[static_cast<std::size_t>(b)];
    const PerEdge q = triangles.strain(batches_.corners(x, b)), tau = triangles.tension(q);
    const Pack work = q[0] * tau[0] + q[1] * tau[1] + q[2] * tau[2];
    for (int lane = 0; lane < batches_.lanes(b); ++lane) twice_E += work[lane];
  }
  return 0.5 * twice_E;
}

PLIANT_INLINE void LinearMembrane::add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer,
                                             ThreadPool* pool) const {
  buffer.numbers.resize(batches_.buffer_size());
  batches_.add(f, buffer.numbers.data(), pool, [&](int b) {
    const Triangles& triangles = triangles_[static_cast<std::size_t>(b)];
    return corner_forces(triangles.tension(triangles.strain(batches_.corners(x, b))), triangles.e);
  });
}

PLIANT_INLINE void LinearMembrane::add_derivative(const Coordinates&, const Coordinates& dx, VecX<double>& f,
                                                  Buffer& buffer, ThreadPool* pool) const {
  add_force(dx, f, buffer, pool);
}

template <class Visit>
void LinearMembrane::each_element(Visit&& visit) const {
  for (int b = 0; b < batches_.n_batches(); ++b) {
    const Triangles& triangles = triangles_[static_cast<std::size_t>(b)];
    for (int lane = 0; lane < batches_.lanes(b); ++lane) {
      Mat3<double> S;
      S << 1, triangles.s01[lane], triangles.s20[lane], triangles.s01[lane], 1, triangles.s12[lane],
          triangles.s20[lane], triangles.s12[lane], 1;
      Eigen::Matrix<double, 3, 9> G = Eigen::Matrix<double, 3, 9>::Zero();  // q_k sqrt(S_kk) = (G d)_k
      for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i) {
          const double e = triangles.e[static_cast<std::size_t>(k)][i][lane];
          G(k, 3 * ((k + 2) % 3) + i) = e;
          G(k, 3 * ((k + 1) % 3) + i) = -e;
        }
      visit(ElementMatrix<9>{batches_.coordinates(b, lane), G.transpose() * S * G});
    }
  }
}

PLIANT_INLINE void LinearMembrane::add_stiffness(const Coordinates&,
                                                 std::vector<Eigen::Triplet<double>>& K) const {
  add_triplets([&](auto&& visit) { each_element(visit); }, K);
}

PLIANT_INLINE double LinearMembrane::frequency_bound(const Coordinates&, const VecX<double>& M) const {
  return largest_element_frequency([&](auto&& visit) { each_element(visit); }, M);
}

}  // namespace pliant
