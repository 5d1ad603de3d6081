// Constants of an isotropic elastic material: Young's modulus E (Pa) and Poisson's ratio nu_P. Lame's
// constants (Pa) are
//   lambda = E nu_P / ((1 + nu_P)(1 - 2 nu_P)),   mu = E / (2 (1 + nu_P)).
#pragma once

namespace pliant {

class Elasticity {
 public:
  /// Throws std::invalid_argument unless E > 0 is finite and -1 < nu_P < 1/2.
  Elasticity(double E, double nu_P);
  double E() const { return E_; }
  double nu_P() const { return nu_P_; }
  double lambda() const { return E_ * nu_P_ / ((1 + nu_P_) * (1 - 2 * nu_P_)); }
  double mu() const { return E_ / (2 * (1 + nu_P_)); }

 private:
  double E_, nu_P_;
};

}  // namespace pliant
