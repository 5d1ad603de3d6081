// Function bodies of solid_energy.h. add_force() evaluates the elastic force element by element: -K q_d of
// Eq. (11) for the linear law, -dE/dx for the other laws.
#pragma once

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include <pliant/local/solid/element_frequency.h>
#include <pliant/local/solid/solid_energy.h>

namespace pliant {

namespace detail {

/// Returns one lane of a tensor.
inline Mat3<double> tensor_lane(const Mat3<Pack>& A, int lane) {
  Mat3<double> B;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) B(i, j) = A(i, j)[lane];
  return B;
}

}  // namespace detail

template <class Element, class Law>
SolidEnergy<Element, Law>::SolidEnergy(const Nodes& rest, const Eigen::MatrixXi& elements, const Law& law)
    : law_(law), corners_(elements, static_cast<int>(rest.rows())) {
  Vec3<Pack> X[N];
  for (int pack = 0; pack < corners_.n_packs(); ++pack) {
    corners_.gather(rest.data(), pack, X);
    for (const TetrahedronPoint& at : Element::rule) {
      const Mat3<Pack> A = Element::gradient(at, X), C = cofactors(A);
      const Pack J = determinant(A, C);
      if (!(min_lane(J) > 0)) {
        std::ostringstream text;
        text << "one of the elements " << pack * Pack::kLanes << " to "
             << std::min((pack + 1) * Pack::kLanes, corners_.n_elements()) - 1
             << " is inverted or flat at rest; its smallest det dX/dxi is " << min_lane(J) << " m^3";
        throw std::invalid_argument(text.str());
      }
      Point point{scaled(Pack(1.0) / J, Mat3<Pack>(C.transpose())), J * Pack(at.weight)};
      for (int lane = 0; lane < Pack::kLanes; ++lane)
        if (pack * Pack::kLanes + lane >= corners_.n_elements()) point.weight.set(lane, 0);
      points_.push_back(point);
    }
  }
}

template <class Element, class Law>
template <int Fields, class Stress>
void SolidEnergy<Element, Law>::subtract_forces(const std::array<const double*, Fields>& fields,
                                                VecX<double>& f, Buffer& buffer, ThreadPool* pool,
                                                Stress&& stress) const {
  buffer.numbers.resize(std::max(buffer.numbers.size(), corners_.buffer_size()));
  corners_.subtract_sums(buffer.numbers.data(), f.data(), pool, [&](int pack, Pack(*terms)[3]) {
    Vec3<Pack> x[Fields][N], force[N];
    for (Vec3<Pack>& f_a : force) f_a.setConstant(Pack(0.0));
    for (std::size_t k = 0; k < Fields; ++k) corners_.gather(fields[k], pack, x[k]);
    const Point* point = points(pack);
    for (const TetrahedronPoint& at : Element::rule) {
      Mat3<Pack> G[Fields];
      for (int k = 0; k < Fields; ++k) G[k] = product(Element::gradient(at, x[k]), point->inverse);
      const Mat3<Pack> P = scaled(point->weight, stress(G));
      Element::add_nodal_forces(at, product_transposed(P, point->inverse), force);
      ++point;
    }
    for (int a = 0; a < N; ++a)
      for (int r = 0; r < 3; ++r) terms[a][r] = force[a][r];
  });
}

template <class Element, class Law>
void SolidEnergy<Element, Law>::add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer,
                                          ThreadPool* pool) const {
  subtract_forces<1>({x.data()}, f, buffer, pool, [&](const Mat3<Pack>* G) { return law_.stress(G[0]); });
}

template <class Element, class Law>
void SolidEnergy<Element, Law>::add_derivative(const Coordinates& x, const Coordinates& dx, VecX<double>& f,
                                               Buffer& buffer, ThreadPool* pool) const {
  if constexpr (Law::constant)
    subtract_forces<1>({dx.data()}, f, buffer, pool, [&](const Mat3<Pack>* G) { return law_.stress(G[0]); });
  else
    subtract_forces<2>({x.data(), dx.data()}, f, buffer, pool,
                       [&](const Mat3<Pack>* G) { return law_.stress_along(G[0], G[1]); });
}

template <class Element, class Law>
void SolidEnergy<Element, Law>::add_viscous_force(const Coordinates& x, const Coordinates& x_dot,
                                                  VecX<double>& f, Buffer& buffer, ThreadPool* pool) const {
  if constexpr (Law::of == Of::displacement)
    add_derivative(x, x_dot, f, buffer, pool);
  else
    subtract_forces<2>({x.data(), x_dot.data()}, f, buffer, pool,
                       [&](const Mat3<Pack>* G) { return viscous_stress(law_.lambda, law_.mu, G[0], G[1]); });
}

template <class Element, class Law>
double SolidEnergy<Element, Law>::energy(const Coordinates& x) const {
  Vec3<Pack> corner[N];
  double E = 0;
  for (int pack = 0; pack < corners_.n_packs(); ++pack) {
    corners_.gather(x.data(), pack, corner);
    const Point* point = points(pack);
    for (const TetrahedronPoint& at : Element::rule) {
      E += sum(point->weight * law_.density(product(Element::gradient(at, corner), point->inverse)));
      ++point;
    }
  }
  return E;
}

template <class Element, class Law>
double SolidEnergy<Element, Law>::volume(int element) const {
  double V = 0;
  for (int k = 0; k < kPoints; ++k) V += points(element / Pack::kLanes)[k].weight[element % Pack::kLanes];
  return V;
}

template <class Element, class Law>
typename SolidEnergy<Element, Law>::GradientMatrix SolidEnergy<Element, Law>::gradient_matrix(
    const TetrahedronPoint& at, const Mat3<double>& inverse) {
  GradientMatrix B = GradientMatrix::Zero();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      // The nodal forces of a unit stress are the derivatives of one component of the gradient.
      Mat3<double> unit = Mat3<double>::Zero();
      unit(r, c) = 1;
      Vec3<double> force[N];
      for (Vec3<double>& f_a : force) f_a.setZero();
      Element::add_nodal_forces(at, product_transposed(unit, inverse), force);
      for (int a = 0; a < N; ++a) B(3 * r + c, 3 * a + r) = force[a][r];
    }
  return B;
}

template <class Element, class Law>
template <class Stress>
typename SolidEnergy<Element, Law>::StressDerivative SolidEnergy<Element, Law>::stress_matrix(
    Stress&& stress) {
  StressDerivative C;
  for (int column = 0; column < 9; ++column) {
    Mat3<double> unit = Mat3<double>::Zero();
    unit(column / 3, column % 3) = 1;
    const Mat3<double> dP = stress(unit);
    for (int row = 0; row < 9; ++row) C(row, column) = dP(row / 3, row % 3);
  }
  return C;
}

template <class Element, class Law>
template <class Derivative>
Eigen::Matrix<double, 3 * SolidEnergy<Element, Law>::N, 3 * SolidEnergy<Element, Law>::N>
SolidEnergy<Element, Law>::element_matrix(const Coordinates& x, int element, Derivative&& derivative) const {
  Eigen::Matrix<double, 3 * N, 3 * N> K = Eigen::Matrix<double, 3 * N, 3 * N>::Zero();
  Vec3<double> corner[N];
  for (int a = 0; a < N; ++a)
    for (int i = 0; i < 3; ++i)
      corner[a][i] = x[static_cast<Eigen::Index>(i) * corners_.n_nodes() + corners_.node(element, a)];
  const int lane = element % Pack::kLanes;
  for (int k = 0; k < kPoints; ++k) {
    const TetrahedronPoint& at = Element::rule[static_cast<std::size_t>(k)];
    const Point& point = points(element / Pack::kLanes)[k];
    const Mat3<double> inverse = detail::tensor_lane(point.inverse, lane);
    const Mat3<double> G = product(Element::gradient(at, corner), inverse);
    const GradientMatrix B = gradient_matrix(at, inverse);
    const StressDerivative C = derivative(G);
    K.noalias() += B.transpose() * (point.weight[lane] * C) * B;
  }
  return K;
}

template <class Element, class Law>
Eigen::Matrix<double, 3 * SolidEnergy<Element, Law>::N, 3 * SolidEnergy<Element, Law>::N>
SolidEnergy<Element, Law>::element_stiffness(const Coordinates& x, int element) const {
  return element_matrix(x, element, [&](const Mat3<double>& G) {
    return stress_matrix([&](const Mat3<double>& dG) { return law_.stress_along(G, dG); });
  });
}

template <class Element, class Law>
template <class Matrix>
void SolidEnergy<Element, Law>::add_entries(std::vector<Eigen::Triplet<double>>& entries,
                                            Matrix&& matrix) const {
  const int n = corners_.n_nodes();
  for (int e = 0; e < corners_.n_elements(); ++e) {
    const Eigen::Matrix<double, 3 * N, 3 * N> K_e = matrix(e);
    for (int a = 0; a < N; ++a)
      for (int b = 0; b < N; ++b)
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j)
            entries.emplace_back(i * n + corners_.node(e, a), j * n + corners_.node(e, b),
                                 K_e(3 * a + i, 3 * b + j));
  }
}

template <class Element, class Law>
void SolidEnergy<Element, Law>::add_stiffness(const Coordinates& x,
                                              std::vector<Eigen::Triplet<double>>& K) const {
  add_entries(K, [&](int e) { return element_stiffness(x, e); });
}

template <class Element, class Law>
void SolidEnergy<Element, Law>::add_viscosity(const Coordinates& x,
                                              std::vector<Eigen::Triplet<double>>& V) const {
  if constexpr (Law::of == Of::displacement)
    add_stiffness(x, V);
  else
    add_entries(V, [&](int e) {
      return element_matrix(x, e, [&](const Mat3<double>& F) {
        return stress_matrix(
            [&](const Mat3<double>& F_dot) { return viscous_stress(law_.lambda, law_.mu, F, F_dot); });
      });
    });
}

template <class Element, class Law>
double SolidEnergy<Element, Law>::frequency_bound(const Coordinates& x, const VecX<double>& M) const {
  return element_frequency_bound(
      corners_, M, [&](int e) { return element_stiffness(x, e); }, [&](int e) { return volume(e); });
}

}  // namespace pliant
