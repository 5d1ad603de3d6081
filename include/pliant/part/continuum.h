// Continuum elasticity of the global parameters q_s. s(u; q_s) is the current position of the material point
// u, and E is the strain energy of the deformation from the rest shape to the current shape:
//   E(q_s) = integral over the rest body of W(F),   F = ds/du(q_s) [ds/du(rest)]^-1
//   f_s = -integral of P : dF/dq_s,   P = dW/dF
// W is the energy density of the law, and P its first Piola-Kirchhoff stress. Damping adds beta P_v to P,
// with P_v = F S(Gdot): S is Hooke's stress and Gdot the rate of Green's strain (local/solid/hooke.h). For
// linear elasticity P_v is the linear stress at the strain rate sym(Fdot). The user gives material constants;
// a matrix K_s is optional. F and its derivatives come from dual numbers: the dual part of a material point
// is a direction in the rest body. The rest shape has the rest values of the parameters at time 0.
#pragma once

#include <array>
#include <string>
#include <variant>
#include <vector>

#include <pliant/local/linear_law.h>
#include <pliant/local/shell/sheet.h>
#include <pliant/local/solid/neo_hookean.h>
#include <pliant/local/solid/neo_hookean_log.h>
#include <pliant/local/solid/st_venant_kirchhoff.h>
#include <pliant/math/scalar/dual.h>
#include <pliant/shape/material.h>

namespace pliant {

class Part;
struct Counters;

/// The name of a law, one of all_continuum_laws(), and the constants of the material. Laws of solids ignore
/// the thickness.
struct ContinuumSettings {
  std::string law = "neo_hookean";
  double E = 0;          ///< Young's modulus, Pa
  double nu_P = 0.3;     ///< Poisson's ratio
  double thickness = 0;  ///< thickness of a shell, m
};

struct ContinuumLawInfo {
  const char* name;
  const char* meaning;
  bool shell;  ///< whether the law is for shells; else it is for solids
};
/// Returns all laws. Each law has the same name as the corresponding law of local deformation
/// (local/local_laws.h).
const std::vector<ContinuumLawInfo>& all_continuum_laws();

/// Quadrature points of the rest body with derivatives along directions X of the rest body: x, y and z for a
/// solid, two orthonormal tangents for a shell.
struct StrainPoints {
  std::array<std::vector<Material<Dual<1, Pack>>>, 3>
      at;                    ///< for each direction X all points, in packs of four
  std::vector<Pack> weight;  ///< m^3 of a solid, m^2 of a shell; 0 in unused lanes
  int n_points = 0;
  int directions = 3;
  std::string rule;  ///< "affine": one point, since all strains are equal; "rings": rings (u, w) = const
  /// Relative change of the integrals when the nodes along a direction are doubled once more: 0 for "affine",
  /// else at least kStrainTolerance. The value is exactly kStrainTolerance if the search converged, or if it
  /// accepted a change of at most 100 kStrainTolerance that finer rules did not halve.
  double relative_error = 0;
};

/// A rule has converged if doubling its nodes changes energy, force, stiffness and volume by at most this
/// relative amount.
inline constexpr double kStrainTolerance = 1e-6;

/// Linear elasticity with the small strain eps = sym(F - I).
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

/// Adds the viscous stress P_v to an elastic law of F.
template <class Law>
struct Damped : Law {
  using Law::Law;
  template <class T>
  Mat3<T> viscous(const Mat3<T>& F, const Mat3<T>& F_dot) const {
    return viscous_stress(Law::lambda, Law::mu, F, F_dot);
  }
};

/// St. Venant-Kirchhoff's law of a sheet. Only the first two columns of F are used. W is energy per area.
struct SheetStrain {
  double lambda, mu;  ///< constants of plane stress times the thickness, N/m
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

using ContinuumLaw = std::variant<SmallStrain, Damped<StVenantKirchhoff>, Damped<NeoHookean>,
                                  Damped<NeoHookeanLog>, SheetStrain>;

/// Returns the law of the settings. Throws std::invalid_argument for an unknown law or impossible constants.
ContinuumLaw continuum_law(const ContinuumSettings& settings);

/// The strain energy of a part.
class ContinuumEnergy {
 public:
  /// Places the quadrature points. volume: volume of a solid at rest, m^3; ignored for a shell. Throws
  /// std::invalid_argument as continuum_law() does, and if the search for quadrature points does not
  /// converge; the message of the second error names the part and its dynamic parameters.
  ContinuumEnergy(const Part& part, const ContinuumSettings& settings, double volume);

  const ContinuumSettings& settings() const { return settings_; }
  const StrainPoints& points() const { return points_; }

  /// Returns the strain energy at q_s, J.
  double energy(const Part& part, const VecMax<double>& q_s) const;
  /// Adds the elastic force -dE/dq_s and the viscous force to f (n_s numbers). beta: factor of the viscous
  /// stress, s. Returns the power of the viscous force (W, at most 0). Throws InvertedElement if the material
  /// of a solid is turned inside out at a quadrature point.
  double add_force(const Part& part, const VecMax<double>& q_s, const VecMax<double>& q_s_dot, double beta,
                   Eigen::Ref<VecX<double>> f, Counters& counters) const;
  /// Computes the forces and the power of add_force() above, with their derivatives along the direction of
  /// the dual parts of q_s and q_s_dot.
  Dual<1> add_force(const Part& part, const VecMax<Dual<1>>& q_s, const VecMax<Dual<1>>& q_s_dot, double beta,
                    Eigen::Ref<VecX<Dual<1>>> f, Counters& counters) const;
  /// Returns d2E/dq_s2 at q_s (n_s x n_s), including the geometric stiffness.
  MatX<double> stiffness(const Part& part, const VecMax<double>& q_s) const;
  /// Returns the damping matrix for beta = 1 s, n_s x n_s: the integral of P_v(F, dF/dq_j) : dF/dq_k. This
  /// matrix is positive semidefinite. If W is quadratic in the strain, the matrix is stiffness() without the
  /// geometric stiffness (the terms with second derivatives of the strain).
  MatX<double> strain_stiffness(const Part& part, const VecMax<double>& q_s) const;

 private:
  ContinuumSettings settings_;
  ContinuumLaw law_;
  StrainPoints points_;
  VecMax<double> unit_;  // scale of each dynamic parameter, for directions of second derivatives
};

}  // namespace pliant
