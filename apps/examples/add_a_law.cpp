// Adds an energy of local deformation, in one class: springs that pull every node to its rest position.
#include <cstdio>

#include <pliant/pliant.h>

using namespace pliant;

// E(d) = 1/2 k sum |d_i|^2 over the nodes i; k in N/m.
class Tether final : public NodalEnergy {
 public:
  Tether(const LocalMesh& mesh, double k) : n_(3 * mesh.X.rows()), k_(k) {}

  Of of() const override { return Of::displacement; }
  bool isotropic() const override { return true; }
  double energy(const Coordinates& d) const override { return 0.5 * k_ * d.head(n_).squaredNorm(); }
  void add_force(const Coordinates& d, VecX<double>& f, Buffer& /*buffer*/,
                 ThreadPool* /*pool*/) const override {
    f.head(n_) -= k_ * d.head(n_);
  }
  void add_derivative(const Coordinates& /*d*/, const Coordinates& change, VecX<double>& f,
                      Buffer& /*buffer*/, ThreadPool* /*pool*/) const override {
    f.head(n_) -= k_ * change.head(n_);
  }
  void add_stiffness(const Coordinates& /*d*/, std::vector<Eigen::Triplet<double>>& K) const override {
    for (int i = 0; i < n_; ++i) K.emplace_back(i, i, k_);
  }
  double frequency_bound(const Coordinates& /*d*/, const VecX<double>& M) const override {
    return k_ / M.head(n_).minCoeff();
  }

 private:
  Eigen::Index n_;
  double k_;
};

int main() {
  LocalSettings settings;
  settings.energies.push_back(
      local_law("st_venant_kirchhoff_membrane", {1e5, 0.3, 1e-3}));  // E (Pa), nu, thickness (m)
  settings.energies.emplace_back([](const LocalMesh& mesh) { return std::make_unique<Tether>(mesh, 1.0); },
                                 "tether");
  settings.displacement = [](const Vec3<double>& x) { return Vec3<double>(0, 0, 0.3 * x[0] * x[2]); };

  MultiBody body;
  auto& ball = body.add<Primitive<Sphere>>("ball", 1.0);  // kg/m^2
  ball.rest({{"r", 0.1}}).make_shell().deform_locally(settings);
  Simulation simulation(body, "rk4");
  for (int i = 0; i < 500; ++i) simulation.step(2e-4);
  const Ledger ledger = simulation.ledger();
  std::printf("local energy %.3e J, energy balance error %.1e J\n", ledger.local, ledger.balance);
}
