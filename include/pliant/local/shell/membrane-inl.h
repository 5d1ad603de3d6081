// Function bodies of membrane.h.
#pragma once

#include <pliant/local/shell/membrane.h>
#include <pliant/local/solid/element_matrix.h>
#include <pliant/math/scalar/dual.h>

namespace pliant {

template <class Law>
Membrane<Law>::Membrane(const ShellMesh& mesh, const Sheet& sheet)
    : batches_(mesh.triangles(), mesh.n_nodes()), triangles_(static_cast<std::size_t>(batches_.n_batches())) {
  sheet.check();
  const VecX<double> X = mesh.X().reshaped();
  for (int b = 0; b < batches_.n_batches(); ++b) {
    Batch& triangles = triangles_[static_cast<std::size_t>(b)];
    for (int lane = 0; lane < Pack::kLanes; ++lane)
      triangles.law.set(lane, edges_of(mesh, batches_.element(b, lane)), sheet);
    // strain() computes the rest values and also all later values, so that q is exactly 0 at rest.
    triangles.rest = {0.0, 0.0, 0.0};
    triangles.rest = triangles.strain(edges_of(batches_.corners(X, b)));
  }
}

template <class Law>
double Membrane<Law>::energy(const Coordinates& x) const {
  double sum = 0;
  for (int b = 0; b < batches_.n_batches(); ++b) {
    const Pack W = batch(b).law.energy(batch(b).strain(edges_of(batches_.corners(x, b))));
    for (int lane = 0; lane < batches_.lanes(b); ++lane) sum += W[lane];
  }
  return sum;
}

template <class Law>
void Membrane<Law>::add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer, ThreadPool* pool) const {
  buffer.numbers.resize(batches_.buffer_size());
  batches_.add(f, buffer.numbers.data(), pool, [&](int b) {
    const Edges<Pack> e = edges_of(batches_.corners(x, b));
    return corner_forces(batch(b).law.tension(batch(b).strain(e)), e);
  });
}

template <class Law>
void Membrane<Law>::add_derivative(const Coordinates& x, const Coordinates& dx, VecX<double>& f,
                                   Buffer& buffer, ThreadPool* pool) const {
  using D = Dual<1, Pack>;
  buffer.numbers.resize(batches_.buffer_size());
  batches_.add(f, buffer.numbers.data(), pool, [&](int b) {
    const Edges<Pack> e = edges_of(batches_.corners(x, b)), de = edges_of(batches_.corners(dx, b));
    const std::array<Pack, 3> q = batch(b).strain(e);
    std::array<D, 3> strain;
    for (std::size_t k = 0; k < 3; ++k) {
      strain[k].v = q[k];
      strain[k].d[0] = e[k].dot(de[k]);
    }
    const std::array<D, 3> tau = batch(b).law.tension(strain);
    ElementBatches<3>::Corners df = corner_forces<Pack>({tau[0].d[0], tau[1].d[0], tau[2].d[0]}, e);
    const ElementBatches<3>::Corners geometric = corner_forces<Pack>({tau[0].v, tau[1].v, tau[2].v}, de);
    for (std::size_t k = 0; k < 3; ++k) df[k] += geometric[k];
    return df;
  });
}

template <class Law>
void Membrane<Law>::add_viscous_force(const Coordinates& x, const Coordinates& x_dot, VecX<double>& f,
                                      Buffer& buffer, ThreadPool* pool) const {
  buffer.numbers.resize(batches_.buffer_size());
  batches_.add(f, buffer.numbers.data(), pool, [&](int b) {
    const Edges<Pack> e = edges_of(batches_.corners(x, b)), e_dot = edges_of(batches_.corners(x_dot, b));
    // The tensions are those of the law linearised at rest, applied to the rates q_dot. The matrix of the
    // linearised law is constant and positive semi-definite.
    return corner_forces<Pack>(batch(b).law.linear_tension(strain_change(e, e_dot)), e);
  });
}

template <class Law>
ElementMatrix<9> Membrane<Law>::element_of(int b, int lane, const Edges<Pack>& e,
                                           const std::array<std::array<Pack, 3>, 3>& slope) const {
  Mat3<double> S;
  Eigen::Matrix<double, 3, 9> G = Eigen::Matrix<double, 3, 9>::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    for (std::size_t l = 0; l < 3; ++l) S(row, static_cast<Eigen::Index>(l)) = slope[k][l][lane];
    for (int i = 0; i < 3; ++i) {
      G(row, 3 * ((row + 2) % 3) + i) = e[k][i][lane];
      G(row, 3 * ((row + 1) % 3) + i) = -e[k][i][lane];
    }
  }
  return {batches_.coordinates(b, lane), G.transpose() * S.selfadjointView<Eigen::Upper>() * G};
}

template <class Law>
template <class Visit>
void Membrane<Law>::each_element(const Coordinates& x, Visit&& visit) const {
  using D = Dual<3, Pack>;
  for (int b = 0; b < batches_.n_batches(); ++b) {
    const Edges<Pack> e = edges_of(batches_.corners(x, b));
    const std::array<Pack, 3> q = batch(b).strain(e);
    const std::array<D, 3> tau = batch(b).law.tension(
        std::array<D, 3>{D::variable(q[0], 0), D::variable(q[1], 1), D::variable(q[2], 2)});
    for (int lane = 0; lane < batches_.lanes(b); ++lane) {
      ElementMatrix<9> element = element_of(b, lane, e, {tau[0].d, tau[1].d, tau[2].d});
      for (int k = 0; k < 3; ++k) {
        const double tension = tau[static_cast<std::size_t>(k)].v[lane];
        const int to = 3 * ((k + 2) % 3), from = 3 * ((k + 1) % 3);
        for (int i = 0; i < 3; ++i) {
          element.K(to + i, to + i) += tension;
          element.K(from + i, from + i) += tension;
          element.K(to + i, from + i) -= tension;
          element.K(from + i, to + i) -= tension;
        }
      }
      visit(element);
    }
  }
}

template <class Law>
void Membrane<Law>::add_stiffness(const Coordinates& x, std::vector<Eigen::Triplet<double>>& K) const {
  add_triplets([&](auto&& visit) { each_element(x, visit); }, K);
}

template <class Law>
void Membrane<Law>::add_viscosity(const Coordinates& x, std::vector<Eigen::Triplet<double>>& V) const {
  add_triplets(
      [&](auto&& visit) {
        for (int b = 0; b < batches_.n_batches(); ++b) {
          const Edges<Pack> e = edges_of(batches_.corners(x, b));
          std::array<std::array<Pack, 3>, 3> slope;  // column k of dtau/dq, equal to row k by symmetry
          for (std::size_t k = 0; k < 3; ++k) {
            std::array<Pack, 3> unit{0.0, 0.0, 0.0};
            unit[k] = 1.0;
            slope[k] = batch(b).law.linear_tension(unit);
          }
          for (int lane = 0; lane < batches_.lanes(b); ++lane) visit(element_of(b, lane, e, slope));
        }
      },
      V);
}

template <class Law>
double Membrane<Law>::frequency_bound(const Coordinates& x, const VecX<double>& M) const {
  return largest_element_frequency([&](auto&& visit) { each_element(x, visit); }, M);
}

}  // namespace pliant
