// Weights of patches of nodes.
#include <pliant/part/local/patch_weights.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include <pliant/part/part.h>

namespace pliant {

namespace {

/// The nodes within the radius that have a positive measure (area or mass). The weights are proportional to
/// phi times the measure; their sum is 1.
struct Patch {
  std::vector<int> node;
  VecX<double> weight;
};

Patch patch_around(const Nodes& X, const Vec3<double>& centre, double radius, const VecX<double>& measure) {
  Patch patch;
  std::vector<double> weights;
  for (Eigen::Index k = 0; k < X.rows(); ++k) {
    const double share = 1 - (X.row(k).transpose() - centre).squaredNorm() / (radius * radius);
    if (!(share > 0) || !(measure[k] > 0)) continue;
    patch.node.push_back(static_cast<int>(k));
    weights.push_back(share * share * measure[k]);
  }
  patch.weight = Eigen::Map<const VecX<double>>(weights.data(), static_cast<Eigen::Index>(weights.size()));
  if (!weights.empty()) patch.weight /= patch.weight.sum();
  return patch;
}

/// Returns 1 and (X - centre) / radius at the nodes of a patch: 4 rows.
Eigen::Matrix4Xd linear_functions(const Patch& patch, const Nodes& X, const Vec3<double>& centre,
                                  double radius) {
  Eigen::Matrix4Xd f(4, static_cast<Eigen::Index>(patch.node.size()));
  for (Eigen::Index k = 0; k < f.cols(); ++k)
    f.col(k) << 1, (X.row(patch.node[static_cast<std::size_t>(k)]).transpose() - centre) / radius;
  return f;
}

}  // namespace

NodeWeights patch_weights(const Part& part, const LocalMesh& mesh, const Material<double>& m, double radius) {
  constexpr int kMinPatchNodes = 5;
  constexpr double kFlatPatch = 1e-10;  // rank threshold for a patch without thickness
  constexpr double kMaxWeightSum = 4;   // sum of |w|; with a larger sum, weights of both signs nearly cancel
  const NodeWeights element = mesh_weights(part, mesh, m);
  if (element.node.empty()) return element;
  const Vec3<double> centre = part.s({m}, part.parameters().rest()).col(0);
  const bool on_surface = m.w == 1;
  const Patch patch = patch_around(mesh.X, centre, radius, on_surface ? mesh.areas() : mesh.mass);
  // The mean position of a patch of a curved surface is not on the surface. For a solid, the correction also
  // changes the weights of nodes inside the body. Because these nodes have different distances from the
  // surface, a small correction suffices.
  const Patch around = mesh.shell() || !on_surface ? patch : patch_around(mesh.X, centre, radius, mesh.mass);
  if (static_cast<int>(patch.node.size()) < kMinPatchNodes) return element;
  const Eigen::Matrix4Xd f = linear_functions(patch, mesh.X, centre, radius),
                         g = linear_functions(around, mesh.X, centre, radius);
  const Eigen::Vector4d missing = Eigen::Vector4d::Unit(0) - f * patch.weight;
  Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix4d> solver;
  solver.setThreshold(kFlatPatch);
  solver.compute(g * around.weight.asDiagonal() * g.transpose());
  VecX<double> w = VecX<double>::Zero(mesh.X.rows());
  const VecX<double> change = around.weight.asDiagonal() * (g.transpose() * solver.solve(missing));
  for (std::size_t k = 0; k < patch.node.size(); ++k)
    w[patch.node[k]] += patch.weight[static_cast<Eigen::Index>(k)];
  for (std::size_t k = 0; k < around.node.size(); ++k)
    w[around.node[k]] += change[static_cast<Eigen::Index>(k)];
  const double error = (mesh.X.transpose() * w - centre).norm();
  if (!(w.lpNorm<1>() <= kMaxWeightSum) || !(error <= 1e-9 * radius)) return element;
  NodeWeights at;
  for (Eigen::Index k = 0; k < w.size(); ++k) {
    if (w[k] == 0) continue;
    at.node.push_back(static_cast<int>(k));
    at.weight.push_back(w[k]);
  }
  return at;
}

}  // namespace pliant
