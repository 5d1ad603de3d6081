// Function bodies of solid_mass.h.
#pragma once

#include <stdexcept>
#include <string>

#include <Eigen/LU>

#include <pliant/local/solid/solid_mass.h>
#include <pliant/local/solid/tetrahedron.h>
#include <pliant/math/header_only.h>

namespace pliant {

namespace detail {

/// Calls add(element, M_e) for every element of one type. M_e: consistent mass matrix over nodes, kg.
template <class Element, class Add>
void for_element_masses(const Nodes& rest, const Eigen::MatrixXi& elements, double density, Add&& add) {
  constexpr int N = Element::n_nodes;
  Vec3<double> X[N];
  for (Eigen::Index e = 0; e < elements.cols(); ++e) {
    for (int a = 0; a < N; ++a) X[a] = rest.row(elements(a, e)).transpose();
    Eigen::Matrix<double, N, N> M = Eigen::Matrix<double, N, N>::Zero();
    for (const TetrahedronPoint& at : kTetrahedronMassRule) {
      const Vec<double, N> n = Element::N(at);
      M += density * at.weight * Element::gradient(at, X).determinant() * (n * n.transpose());
    }
    add(e, M);
  }
}

/// Calls add(element, M_e) for every element; the number of rows of `elements` gives the type of element.
template <class Add>
void for_each_element_mass(const Nodes& rest, const Eigen::MatrixXi& elements, double density, Add&& add) {
  if (elements.rows() == LinearTetrahedron::n_nodes)
    for_element_masses<LinearTetrahedron>(rest, elements, density, add);
  else if (elements.rows() == QuadraticTetrahedron::n_nodes)
    for_element_masses<QuadraticTetrahedron>(rest, elements, density, add);
  else if (elements.rows() == EnrichedTetrahedron::n_nodes)
    for_element_masses<EnrichedTetrahedron>(rest, elements, density, add);
  else
    throw std::invalid_argument("elements have " + std::to_string(elements.rows()) +
                                " nodes; masses need elements with 4, 10 or 15");
}

}  // namespace detail

PLIANT_INLINE VecX<double> lumped_mass(const Nodes& rest, const Eigen::MatrixXi& elements, double density) {
  VecX<double> mass = VecX<double>::Zero(rest.rows());
  if (elements.rows() == EnrichedTetrahedron::n_nodes) {
    Vec3<double> X[EnrichedTetrahedron::n_nodes];
    for (Eigen::Index e = 0; e < elements.cols(); ++e) {
      for (int a = 0; a < EnrichedTetrahedron::n_nodes; ++a) X[a] = rest.row(elements(a, e)).transpose();
      for (int a = 0; a < EnrichedTetrahedron::n_nodes; ++a) {
        const TetrahedronPoint& node = kEnrichedNodes[static_cast<std::size_t>(a)];
        mass[elements(a, e)] += density * node.weight * EnrichedTetrahedron::gradient(node, X).determinant();
      }
    }
    return mass;
  }
  detail::for_each_element_mass(rest, elements, density, [&](Eigen::Index e, const auto& M) {
    const double scale = M.sum() / M.trace();
    for (Eigen::Index a = 0; a < elements.rows(); ++a) mass[elements(a, e)] += scale * M(a, a);
  });
  return mass;
}

PLIANT_INLINE std::vector<Eigen::Triplet<double>> consistent_mass(const Nodes& rest,
                                                                  const Eigen::MatrixXi& elements,
                                                                  double density) {
  std::vector<Eigen::Triplet<double>> all;
  detail::for_each_element_mass(rest, elements, density, [&](Eigen::Index e, const auto& M) {
    for (Eigen::Index a = 0; a < elements.rows(); ++a)
      for (Eigen::Index b = 0; b < elements.rows(); ++b)
        all.emplace_back(elements(a, e), elements(b, e), M(a, b));
  });
  return all;
}

}  // namespace pliant
