#include <pliant/part/local_deformation.h>

#include <sstream>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <pliant/part/nodal_deformation.h>

namespace pliant {

std::unique_ptr<LocalDeformation> make_local_deformation(const Part& part, const LocalSettings& settings) {
  return std::make_unique<NodalDeformation>(part, settings);
}

void LocalDeformation::check_start(const Part& part, const Nodes& displacements, const VecX<double>& rates) {
  const double farthest = displacements.rowwise().norm().maxCoeff();
  if (farthest <= part.size() && rates.allFinite()) return;
  std::ostringstream message;
  message << "part '" << part.name() << "': at time 0 nodes are displaced by " << farthest
          << " m; expected no more than its size, " << part.size() << " m, and finite velocities";
  throw std::invalid_argument(message.str());
}

MatX<double> LocalDeformation::inverse_of(const MatX<double>& A) {
  constexpr double smallest = 1e-11;  // eigenvalue of A scaled to a unit diagonal
  const VecX<double> scale = A.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const MatX<double> scaled = scale.asDiagonal() * A * scale.asDiagonal();
  constexpr double well_conditioned = 1e-8;
  const Eigen::LLT<MatX<double>> factor(scaled);
  if (factor.info() == Eigen::Success && factor.rcond() > well_conditioned)
    return scale.asDiagonal() * factor.solve(MatX<double>(scale.asDiagonal()));
  const Eigen::SelfAdjointEigenSolver<MatX<double>> eigen(scaled);
  VecX<double> inverse = eigen.eigenvalues();
  for (double& value : inverse) value = value > smallest ? 1 / value : 0;
  const MatX<double> V = scale.asDiagonal() * eigen.eigenvectors();
  return V * inverse.asDiagonal() * V.transpose();
}

VecX<double> at_points(const std::vector<NodeWeights>& points, const Eigen::Ref<const Nodes>& values) {
  VecX<double> x = VecX<double>::Zero(3 * static_cast<Eigen::Index>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k)
    for (std::size_t i = 0; i < points[k].node.size(); ++i)
      x.segment<3>(3 * static_cast<Eigen::Index>(k)) +=
          points[k].weight[i] * values.row(points[k].node[i]).transpose();
  return x;
}

}  // namespace pliant
