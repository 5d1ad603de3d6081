// A simple energy of local deformation for tests: a net of springs.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include <pliant/part/local/local_deformation.h>

namespace pliant::test {

/// The energy 1/2 k sum |d_i - d_j|^2 over the edges (i, j) of a closed mesh; d_i: displacement of node i, m;
/// k: stiffness, N/m. The stiffness matrix is not implemented: add_stiffness() adds nothing.
class Net final : public NodalEnergy {
 public:
  Net(const LocalMesh& mesh, double k) : triangles_(mesh.triangles), n_(mesh.X.rows()), k_(k) {}
  Of of() const override { return Of::displacement; }
  double energy(const Coordinates& x) const override {
    VecX<double> f = VecX<double>::Zero(x.size());
    Buffer none;
    add_force(x, f, none, nullptr);
    return -0.5 * x.dot(f);
  }
  void add_force(const Coordinates& x, VecX<double>& f, Buffer&, ThreadPool*) const override {
    auto d = nodes(x, n_);
    auto force = nodes(f, n_);
    for (Eigen::Index t = 0; t < triangles_.cols(); ++t)
      for (int e = 0; e < 3; ++e) {
        const int i = triangles_(e, t), j = triangles_((e + 1) % 3, t);
        if (i > j) continue;
        const Eigen::RowVector3d pull = k_ * (d.row(j) - d.row(i));
        force.row(i) += pull;
        force.row(j) -= pull;
      }
  }
  void add_derivative(const Coordinates&, const Coordinates& dx, VecX<double>& f, Buffer& buffer,
                      ThreadPool* pool) const override {
    add_force(dx, f, buffer, pool);
  }
  void add_stiffness(const Coordinates&, std::vector<Eigen::Triplet<double>>&) const override {}
  double frequency_bound(const Coordinates&, const VecX<double>& M) const override {
    return 24 * k_ / M.minCoeff();
  }

 private:
  Eigen::Matrix3Xi triangles_;
  Eigen::Index n_;
  double k_;
};

/// Returns settings of local deformation with the energy Net. resolution: of the mesh; k: stiffness, N/m.
inline LocalSettings net(int resolution, double k) {
  LocalSettings settings;
  settings.resolution = resolution;
  settings.energies.push_back([k](const LocalMesh& mesh) { return std::make_unique<Net>(mesh, k); });
  return settings;
}

/// Return the displacement (m) and the velocity (m/s) of a node with the rest position X (m). Both functions
/// are smooth.
inline Vec3<double> sample_displacement(const Vec3<double>& X) {
  return 0.03 * Vec3<double>(std::sin(3 * X[0] + X[1]), std::cos(2 * X[2]) * X[0], X[1] * X[2] + 0.2);
}
inline Vec3<double> sample_velocity(const Vec3<double>& X) {
  return 0.2 * Vec3<double>(X[1] * X[2], std::sin(4 * X[0]), std::cos(3 * X[1]));
}

}  // namespace pliant::test
