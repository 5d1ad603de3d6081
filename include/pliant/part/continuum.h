// Continuum elasticity of a part without nodes (design 1.4): the strain energy of the whole map from rest to
// now, of its global parameters,
//   E(q_s) = integral over the rest body of W(F),   F = ds/du(q_s) [ds/du(rest)]^-1
//   f_s = -integral of P : dF/dq_s,   P = dW/dF;   damping: P_v = beta F S(Gdot) beside P (hooke.h)
// from material constants instead of a table of stiffnesses. F and its derivatives come from dual numbers
// that carry a direction of the rest body in the material points. The map of rest is that of time 0.
#pragma once

#include <array>
#include <string>
#include <variant>
#include <vector>

#include <pliant/local/linear_law.h>
#include <pliant/local/shell/sheet.h>
#include <pliant/local/solid/neo_hookean.h>
#include <pliant/local/solid/st_venant_kirchhoff.h>
#include <pliant/math/scalar/dual.h>
#include <pliant/shape/material.h>

namespace pliant {

class Part;
struct Counters;

/// Which law, by its name among all_continuum_laws(), and the constants of the material.
struct ContinuumSettings {
  std::string law = "neo_hookean";
  double E = 0;          ///< Young's modulus, Pa
  double nu_P = 0.3;     ///< Poisson's number
  double thickness = 0;  ///< of a shell, m
};

struct ContinuumLawInfo {
  const char* name;
  const char* meaning;
  bool shell;  ///< of shells; else of solids
};
/// The laws, called as those of local deformation.
const std::vector<ContinuumLawInfo>& all_continuum_laws();

/// Points of the rest body with derivatives along directions X there; of a shell two tangents and no third.
struct StrainPoints {
  std::array<std::vector<Material<Dual<1, Pack>>>, 3> at;  ///< four points each
  std::vector<Pack> weight;  ///< m^3, of a shell m^2; 0 in lanes without a point
  int n_points = 0;
  int directions = 3;
  std::string rule;  ///< "affine" one point for all, "rings" of material points
  /// Relative change of the integrals that doubling the rule still makes.
  double settled = 0;
};

/// Relative change of the energy, its force and its stiffness by doubling at which a rule is fine enough.
inline constexpr double kStrainSettled = 1e-6;

/// The law of small strains of the whole map: eps = sym(F - I).
struct SmallStrain {
  LinearLaw law;
  explicit SmallStrain(const Elasticity& material) : law(material) {}
  template <class T>
  T density(const Mat3<T>& F) const {
    return law.density(displacement(F));
  }
  template <class T>
  Mat3<T> stress(const Mat3<T>& F) const {
    return law.stress(displacement(F));
  }
  template <class T>
  Mat3<T> viscous(const Mat3<T>&, const Mat3<T>& F_dot) const {
    return law.stress(F_dot);
  }

 private:
  template <class T>
  static Mat3<T> displacement(Mat3<T> F) {
    for (int i = 0; i < 3; ++i) F(i, i) -= T(1.0);
    return F;
  }
};

/// A law of F beside its damping.
template <class Law>
struct Damped : Law {
  using Law::Law;
  template <class T>
  Mat3<T> viscous(const Mat3<T>& F, const Mat3<T>& F_dot) const {
    return viscous_stress(Law::lambda, Law::mu, F, F_dot);
  }
};

/// St. Venant-Kirchhoff's law of a sheet of which F has two columns: W per area.
struct SheetStrain {
  double lambda, mu;  ///< of plane stress times the thickness, N/m
  explicit SheetStrain(const Sheet& sheet)
      : lambda(sheet.thickness * sheet.lambda()), mu(sheet.thickness * sheet.mu()) {}
  template <class T>
  T density(const Mat3<T>& F) const {
    const Mat3<T> G = green_strain<2>(F);
    return contraction(hooke_stress<2>(lambda, mu, G), G) * T(0.5);
  }
  template <class T>
  Mat3<T> stress(const Mat3<T>& F) const {
    return product(F, hooke_stress<2>(lambda, mu, green_strain<2>(F)));
  }
  template <class T>
  Mat3<T> viscous(const Mat3<T>& F, const Mat3<T>& F_dot) const {
    return viscous_stress<2>(lambda, mu, F, F_dot);
  }
};

using ContinuumLaw = std::variant<SmallStrain, Damped<StVenantKirchhoff>, Damped<NeoHookean>, SheetStrain>;

/// Throws std::invalid_argument for constants that make no material.
ContinuumLaw continuum_law(const ContinuumSettings& settings);

class ContinuumEnergy {
 public:
  /// volume: of the part at rest, m^3. Throws std::invalid_argument, naming the parameters, where no rule
  /// gives the energy.
  ContinuumEnergy(const Part& part, const ContinuumSettings& settings, double volume);

  const ContinuumSettings& settings() const { return settings_; }
  const StrainPoints& points() const { return points_; }

  /// J.
  double energy(const Part& part, const VecMax<double>& q_s) const;
  /// f -= dE/dq_s and beta times the damping; returns the power of the latter, W. Throws InvertedElement
  /// where the body is turned inside out at one of its points.
  double add_force(const Part& part, const VecMax<double>& q_s, const VecMax<double>& q_s_dot, double beta,
                   Eigen::Ref<VecX<double>> f, Counters& counters) const;
  /// The same with derivatives along the direction that q_s and q_s_dot carry.
  Dual<1> add_force(const Part& part, const VecMax<Dual<1>>& q_s, const VecMax<Dual<1>>& q_s_dot, double beta,
                    Eigen::Ref<VecX<Dual<1>>> f, Counters& counters) const;
  /// d2E/dq_s2, exact.
  MatX<double> stiffness(const Part& part, const VecMax<double>& q_s) const;
  /// The part of it that strains make without the stress: what beta multiplies; never negative.
  MatX<double> strain_stiffness(const Part& part, const VecMax<double>& q_s) const;

 private:
  ContinuumSettings settings_;
  ContinuumLaw law_;
  StrainPoints points_;
  VecMax<double> unit_;  ///< of the dynamic parameters, in which second derivatives are taken
};

}  // namespace pliant
