#include <pliant/local/solid/solid_mass.h>

#include <stdexcept>
#include <string>

#include <Eigen/LU>

#include <pliant/local/solid/tetrahedron.h>

namespace pliant {

namespace {

/// add(element, M_e) for every element.
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

/// The same for elements of either kind.
template <class Add>
void for_all_masses(const Nodes& rest, const Eigen::MatrixXi& elements, double density, Add&& add) {
  if (elements.rows() == LinearTetrahedron::n_nodes)
    for_element_masses<LinearTetrahedron>(rest, elements, density, add);
  else if (elements.rows() == QuadraticTetrahedron::n_nodes)
    for_element_masses<QuadraticTetrahedron>(rest, elements, density, add);
  else if (elements.rows() == EnrichedTetrahedron::n_nodes)
    for_element_masses<EnrichedTetrahedron>(rest, elements, density, add);
  else
    throw std::invalid_argument("elements of " + std::to_string(elements.rows()) +
                                " nodes have no masses; 4, 10 or 15 do");
}

}  // namespace

VecX<double> lumped_mass(const Nodes& rest, const Eigen::MatrixXi& elements, double density) {
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
  for_all_masses(rest, elements, density, [&](Eigen::Index e, const auto& M) {
    const double scale = M.sum() / M.trace();
    for (Eigen::Index a = 0; a < elements.rows(); ++a) mass[elements(a, e)] += scale * M(a, a);
  });
  return mass;
}

std::vector<Eigen::Triplet<double>> consistent_mass(const Nodes& rest, const Eigen::MatrixXi& elements,
                                                    double density) {
  std::vector<Eigen::Triplet<double>> all;
  for_all_masses(rest, elements, density, [&](Eigen::Index e, const auto& M) {
    for (Eigen::Index a = 0; a < elements.rows(); ++a)
      for (Eigen::Index b = 0; b < elements.rows(); ++b)
        all.emplace_back(elements(a, e), elements(b, e), M(a, b));
  });
  return all;
}

}  // namespace pliant
