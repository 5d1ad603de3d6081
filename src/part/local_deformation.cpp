#include <pliant/part/local_deformation.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include <pliant/part/part.h>
#include <pliant/part/surface.h>

namespace pliant {

namespace {

/// A third of the area of the triangles at each node.
VecX<double> node_areas(const LocalMesh& mesh) {
  VecX<double> area = VecX<double>::Zero(mesh.X.rows());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corner = [&](int k) -> Vec3<double> { return mesh.X.row(mesh.triangles(k, t)).transpose(); };
    const double third = (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 6;
    for (int k = 0; k < 3; ++k) area[mesh.triangles(k, t)] += third;
  }
  return area;
}

/// Moments of mass of order 0, 1 and 2 of a point, in units of a length.
Vec<double, 10> moments(const Vec3<double>& x) {
  Vec<double, 10> f;
  f << 1, x[0], x[1], x[2], x[0] * x[0], x[1] * x[1], x[2] * x[2], x[0] * x[1], x[1] * x[2], x[2] * x[0];
  return f;
}
/// The same of a whole part.
Vec<double, 10> moments(const Inertia<double>& whole, double unit) {
  const Mat3<double> I = whole.M.block<3, 3>(3, 3) / (unit * unit);
  const Vec3<double> square = 0.5 * I.trace() * Vec3<double>::Ones() - I.diagonal();
  Vec<double, 10> f;
  f << whole.mass, whole.moment / unit, square, -I(0, 1), -I(1, 2), -I(2, 0);
  return f;
}

/// Changes masses as little as it takes, relative to themselves, to give them the mass, the centre and the
/// second moments of the part without nodes.
void match_moments(const Inertia<double>& whole, double unit, const Nodes& X, VecX<double>& mass) {
  const Eigen::Index n = X.rows();
  MatX<double> F(10, n);
  for (Eigen::Index k = 0; k < n; ++k) F.col(k) = moments(Vec3<double>(X.row(k).transpose() / unit));
  const Vec<double, 10> missing = moments(whole, unit) - F * mass;
  // Least sum m c^2 with sum m c f = what is missing: c = f^T y.
  const Eigen::Matrix<double, 10, 10> A = F * mass.asDiagonal() * F.transpose();
  Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix<double, 10, 10>> solver;
  solver.setThreshold(1e-10);
  solver.compute(A);
  const VecX<double> change = F.transpose() * solver.solve(missing);
  mass.array() *= 1 + change.array();
}

/// Weights of the point of a triangle that is nearest to x.
Vec3<double> nearest_on_triangle(const Vec3<double>& x, const std::array<Vec3<double>, 3>& corner) {
  const Vec3<double> e1 = corner[1] - corner[0], e2 = corner[2] - corner[0], r = x - corner[0];
  const double a = e1.dot(e1), b = e1.dot(e2), c = e2.dot(e2), d = e1.dot(r), e = e2.dot(r);
  const double det = a * c - b * b;
  const double s = (c * d - b * e) / det, t = (a * e - b * d) / det;
  if (s >= 0 && t >= 0 && s + t <= 1) return {1 - s - t, s, t};
  Vec3<double> best = Vec3<double>::Zero();
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k), j = static_cast<std::size_t>((k + 1) % 3);
    const Vec3<double> edge = corner[j] - corner[i];
    const double along = std::clamp((x - corner[i]).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    const double distance = (x - corner[i] - along * edge).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    best.setZero();
    best[k] = 1 - along;
    best[(k + 1) % 3] = along;
  }
  return best;
}

}  // namespace

LocalDeformation::LocalDeformation(const Part& part, const LocalSettings& settings)
    : alpha_(settings.alpha), beta_(settings.beta) {
  const Surface surface(part, settings.resolution);
  mesh_.nodes = surface.material();
  mesh_.triangles = surface.triangles();
  mesh_.X = part.s(mesh_.nodes, part.parameters().rest()).transpose();
  mesh_.mass = node_areas(mesh_);
  mesh_.mass *= part.total_mass() / mesh_.mass.sum();
  match_moments(part.rest_inertia(), part.size(), mesh_.X, mesh_.mass);
  if (!(mesh_.mass.minCoeff() > 0))
    throw std::invalid_argument("part '" + part.name() + "': a mesh of resolution " +
                                std::to_string(settings.resolution) +
                                " is too coarse for its masses to be positive");
  for (std::size_t first = 0; first < mesh_.nodes.size(); first += Pack::kLanes) {
    std::array<Material<double>, Pack::kLanes> four;
    for (std::size_t i = 0; i < Pack::kLanes; ++i)
      four[i] = mesh_.nodes[std::min(first + i, mesh_.nodes.size() - 1)];
    packs_.push_back(gather(four.data()));
  }
  VecX<double> own;
  for (const LocalSettings::Law& law : settings.energies) {
    energies_.push_back(law(mesh_));
    const VecX<double> more = energies_.back()->own_inertia();
    if (more.size() == 0) continue;
    if (own.size() > 0)
      throw std::invalid_argument("part '" + part.name() +
                                  "': only one of its energies may have coordinates of its own");
    own = more;
  }
  inertia_.resize(3 * n_nodes() + own.size());
  inertia_ << mesh_.mass, mesh_.mass, mesh_.mass, own;
  mobility_ = inertia_.cwiseInverse();
  auto at_nodes = [&](const std::function<Vec3<double>(const Vec3<double>&)>& of) {
    VecX<double> values = VecX<double>::Zero(n_d());
    for (Eigen::Index k = 0; of && k < n_nodes(); ++k)
      nodes(values, n_nodes()).row(k) = of(mesh_.X.row(k).transpose()).transpose();
    return values;
  };
  initial_ = at_nodes(settings.displacement);
  initial_rate_ = at_nodes(settings.velocity);
}

NodeWeights LocalDeformation::weights(const Part& part, const Material<double>& m) const {
  NodeWeights best;
  if (mesh_.shell() && m.w < 1) return best;
  const Vec3<double> x = part.s({m}, part.parameters().rest()).col(0);
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index t = 0; t < mesh_.triangles.cols(); ++t) {
    std::array<Vec3<double>, 3> corner;
    for (int k = 0; k < 3; ++k)
      corner[static_cast<std::size_t>(k)] = mesh_.X.row(mesh_.triangles(k, t)).transpose();
    const Vec3<double> weight = nearest_on_triangle(x, corner);
    const double distance =
        (x - weight[0] * corner[0] - weight[1] * corner[1] - weight[2] * corner[2]).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    best = {};
    for (int k = 0; k < 3; ++k) {
      if (weight[k] == 0) continue;
      best.node.push_back(mesh_.triangles(k, t));
      best.weight.push_back(weight[k]);
    }
  }
  return best;
}

}  // namespace pliant
