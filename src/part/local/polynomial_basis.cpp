// Displacement polynomials over the body of a solid. The fields phi = T L are combinations of the products
// L of Legendre polynomials (LegendreProducts). The mean of phi_a phi_b over the volume is delta_ab, and
// d phi / dX_r = Delta_r phi with a matrix Delta_r. With the volume V and Lame's constants lambda and mu, the
// stiffness of linear elasticity is then
//   K_rs = V (lambda Delta_r Delta_s^T + mu Delta_s Delta_r^T + delta_rs mu sum_t Delta_t Delta_t^T),
// without a quadrature of gradients.
#include <algorithm>
#include <array>
#include <stdexcept>

#include <Eigen/Cholesky>

#include <pliant/part/local/modal_basis.h>
#include <pliant/part/local/mode_conditions.h>
#include <pliant/part/mesh/surface.h>
#include <pliant/part/part.h>

#include "part/quadrature/body_rule.h"

namespace pliant {

namespace {

/// Maximum number of values of all fields at all points of a basis. These values need 400 MB.
constexpr double kMaxValues = 5e7;

/// The fields phi = T L.
struct PolynomialFields {
  LegendreProducts L;
  MatX<double> T;  ///< lower triangular

  /// Returns phi at points X: points x fields.
  MatX<double> at(const Eigen::Matrix3Xd& X) const { return L.values(X) * T.transpose(); }
};

/// Returns fields phi = T L for which the mean of phi_a phi_b over the body is delta_ab. T is the inverse
/// Cholesky factor of the Gram matrix of L. A second pass reduces the rounding errors of the first pass.
PolynomialFields orthonormal(const Part& part, const LegendreProducts& L, const BodyRule& rule) {
  PolynomialFields fields{L, MatX<double>::Identity(L.size(), L.size())};
  const VecX<double> weight = rule.volume / rule.volume.sum();
  for (int pass = 0; pass < 2; ++pass) {
    MatX<double> gram = MatX<double>::Zero(L.size(), L.size());
    constexpr Eigen::Index block = 2048;
    for (Eigen::Index first = 0; first < rule.X.cols(); first += block) {
      const Eigen::Index count = std::min(block, rule.X.cols() - first);
      const MatX<double> phi = fields.at(rule.X.middleCols(first, count));
      gram.noalias() += phi.transpose() * weight.segment(first, count).asDiagonal() * phi;
    }
    const Eigen::LLT<MatX<double>> factor(gram);
    if (factor.info() != Eigen::Success)
      throw std::invalid_argument("part '" + part.name() +
                                  "': polynomials of this degree are not independent over its body");
    fields.T = factor.matrixL().solve(fields.T).eval();
  }
  return fields;
}

/// Returns the stiffness matrix K of linear elasticity. The constants lambda and mu are sums over all laws.
MatX<double> stiffness(const PolynomialFields& fields, const std::vector<Elasticity>& laws, double volume) {
  const Eigen::Index n = fields.L.size();
  std::array<MatX<double>, 3> gradient;
  for (int r = 0; r < 3; ++r) {
    const MatX<double> of_L = fields.T * fields.L.derivative(r);
    gradient[static_cast<std::size_t>(r)] =
        fields.T.transpose().triangularView<Eigen::Upper>().solve(of_L.transpose()).transpose();
  }
  double lambda = 0, mu = 0;
  for (const Elasticity& law : laws) {
    lambda += law.lambda();
    mu += law.mu();
  }
  MatX<double> K = MatX<double>::Zero(3 * n, 3 * n), laplace = MatX<double>::Zero(n, n);
  for (const MatX<double>& along : gradient) laplace.noalias() += along * along.transpose();
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t s = 0; s < 3; ++s) {
      const MatX<double> product = gradient[r] * gradient[s].transpose();
      const auto row = static_cast<Eigen::Index>(r) * n, column = static_cast<Eigen::Index>(s) * n;
      K.block(row, column, n, n) += volume * lambda * product;
      K.block(column, row, n, n) += volume * mu * product;
      if (r == s) K.block(row, row, n, n) += volume * mu * laplace;
    }
  return K;
}

}  // namespace

ModalBasis make_polynomials(const Part& part, const LocalSettings& settings) {
  const std::string name = "part '" + part.name() + "': ";
  if (part.shell())
    throw std::invalid_argument(
        name +
        "displacement polynomials are for solids, and the part is a shell; expected the "
        "basis \"nodes\" or \"modes\"");
  std::vector<Elasticity> laws;
  for (const LocalLaw& law : settings.energies) {
    if (!law.linear)
      throw LocalFault(name + "displacement polynomials support only linear elasticity, not the law '" +
                           law.name + "'; expected \"elastic\", or the basis \"nodes\"",
                       static_cast<int>(laws.size()));
    laws.push_back(*law.linear);
  }
  if (settings.degree < 1 || settings.degree > 10)
    throw std::invalid_argument(name + "polynomials of degree " + std::to_string(settings.degree) +
                                "; expected 1 to 10");
  ModalBasis basis;
  const Surface surface(part, settings.resolution);
  basis.mesh.nodes = surface.material();
  basis.mesh.triangles = surface.triangles();
  const Eigen::Matrix3Xd shown = part.s(basis.mesh.nodes, part.parameters().rest());
  basis.mesh.X = shown.transpose();
  Eigen::AlignedBox3d box;
  for (Eigen::Index k = 0; k < shown.cols(); ++k) box.extend(Vec3<double>(shown.col(k)));

  BodyRule rule = make_body_rule(part, LegendreProducts(box, 2 * settings.degree));
  const LegendreProducts L(box, settings.degree);
  const double values = static_cast<double>(L.size()) * static_cast<double>(rule.X.cols());
  if (values > kMaxValues)
    throw std::invalid_argument(
        name + std::to_string(L.size()) + " polynomials at " + std::to_string(rule.X.cols()) +
        " points of its body need more numbers than " + std::to_string(static_cast<long>(kMaxValues)) +
        "; expected a lower degree or a smoother shape");
  const PolynomialFields fields = orthonormal(part, L, rule);
  const double volume = rule.volume.sum();
  const Eigen::Index n = L.size();
  basis.mass = VecX<double>::Constant(n, part.total_mass());
  basis.project = fields.at(rule.X).transpose() * (rule.volume / volume).asDiagonal();
  basis.points = std::move(rule.at);
  basis.points_at_rest = rule.X.transpose();
  basis.X = basis.project * basis.points_at_rest;
  basis.shown = fields.at(shown);
  basis.made_of = "polynomials of degree " + std::to_string(settings.degree);
  basis.weights = [fields](const Part& of_part, const Material<double>& m) {
    const MatX<double> phi = fields.at(of_part.s({m}, of_part.parameters().rest()));
    NodeWeights at;
    for (Eigen::Index a = 0; a < phi.cols(); ++a) {
      at.node.push_back(static_cast<int>(a));
      at.weight.push_back(phi(0, a));
    }
    return at;
  };
  diagonalise(part, stiffness(fields, laws, volume), basis);
  return basis;
}

}  // namespace pliant
