// Laws of membranes for large deformation: the energy W(q) of a triangle, J. q measures the change of the
// three edges (edge_strain.h). With Green's strain G = sum over edges i of q_i B_i, C = 1 + 2 G, rest area A
// and rest thickness t,
//   St. Venant-Kirchhoff   W = A t [lambda/2 (tr G)^2 + mu G:G] = 1/2 q S q
//   neo-Hookean            W = A t mu/2 [tr C - 2 + V(D)],  D = det C.
// The neo-Hookean laws are solids in plane stress: the thickness becomes sqrt(s) t, with s(D) such that the
// stress across the sheet is 0. Then V' = -s/D. There are two such laws (squared_thickness.h):
//   neo_hookean_membrane       the compressible material of Blatz & Ko (1962)
//   neo_hookean_log_membrane   the classical law with ln J (solid/neo_hookean_log.h)
// For nu = 1/2 both laws describe incompressible rubber.
#pragma once

#include <array>

#include <Eigen/Geometry>

#include <pliant/local/shell/edge_strain.h>
#include <pliant/local/shell/squared_thickness.h>

namespace pliant {

/// Members of a law: its name, and `Triangles` with the constants of four triangles and with these functions:
/// set() computes the constants of one triangle with rest edges e. energy() returns W. tension() returns tau
/// = dW/dq, N/m; linear_tension() returns the linearisation of tau at rest. T is Pack or a dual number.
struct StVenantKirchhoffSheet {
  static constexpr const char* name = "st_venant_kirchhoff";

  struct Triangles {
    std::array<Pack, 3> diagonal, off_diagonal;  ///< S_00 S_11 S_22, S_12 S_20 S_01

    void set(int lane, const Edges<double>& e, const Sheet& sheet) {
      const Mat3<double> S = edge_stiffness(e, sheet);
      for (int k = 0; k < 3; ++k) {
        diagonal[static_cast<std::size_t>(k)].set(lane, S(k, k));
        off_diagonal[static_cast<std::size_t>(k)].set(lane, S((k + 1) % 3, (k + 2) % 3));
      }
    }
    template <class T>
    std::array<T, 3> tension(const std::array<T, 3>& q) const {
      std::array<T, 3> tau;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        tau[k] = q[k] * diagonal[k] + q[i] * off_diagonal[j] + q[j] * off_diagonal[i];
      }
      return tau;
    }
    std::array<Pack, 3> linear_tension(const std::array<Pack, 3>& q) const { return tension(q); }
    Pack energy(const std::array<Pack, 3>& q) const {
      const std::array<Pack, 3> tau = tension(q);
      return 0.5 * (q[0] * tau[0] + q[1] * tau[1] + q[2] * tau[2]);
    }
  };
};

/// See StVenantKirchhoffSheet for the members. Thickness: BlatzKoThickness or LogThickness.
template <class Thickness>
struct RubberSheet {
  static constexpr const char* name = Thickness::name;

  struct Triangles {
    std::array<Pack, 3> trace;  ///< tr B_i of each edge i
    Pack inverse;               ///< 1/(2 A)^2, 1/m^4
    Pack stiffness;             ///< A t mu / 2, J
    Thickness thickness{0};
    StVenantKirchhoffSheet::Triangles linear;  ///< this material at small strains

    void set(int lane, const Edges<double>& e, const Sheet& sheet) {
      const Vec3<double> tr = edge_traces(e);
      for (int i = 0; i < 3; ++i) trace[static_cast<std::size_t>(i)].set(lane, tr[i]);
      const double twice_area = e[0].cross(e[1]).norm();
      inverse.set(lane, 1 / (twice_area * twice_area));
      stiffness.set(lane, 0.25 * twice_area * sheet.thickness * sheet.mu());
      thickness = Thickness(sheet.nu);
      linear.set(lane, e, sheet);
    }
    std::array<Pack, 3> linear_tension(const std::array<Pack, 3>& q) const { return linear.tension(q); }
    /// Returns tr G.
    template <class T>
    T strain_trace(const std::array<T, 3>& q) const {
      return q[0] * trace[0] + q[1] * trace[1] + q[2] * trace[2];
    }
    /// Returns D - 1 = 2 tr G + 4 det G. det G comes from Heron's formula for the area.
    template <class T>
    T D_minus_1(const std::array<T, 3>& q) const {
      const T det = q[0] * (q[1] + q[1] - q[0]) + q[1] * (q[2] + q[2] - q[1]) + q[2] * (q[0] + q[0] - q[2]);
      return 2.0 * strain_trace(q) + det * inverse;
    }
    template <class T>
    std::array<T, 3> tension(const std::array<T, 3>& q) const {
      // dW = stiffness (2 tr dG - s/D dD) with dD = 2 tr dG + d(4 det G). The terms are written with `loss`,
      // which is small near rest, to avoid cancellation.
      const T D = 1.0 + D_minus_1(q);
      const T loss = 1.0 - thickness.share(D);
      std::array<T, 3> tau;
      for (std::size_t i = 0; i < 3; ++i) {
        const T slope = 2.0 * (q[(i + 1) % 3] + q[(i + 2) % 3] - q[i]) * inverse;  // d(4 det G)/dq_i
        tau[i] = (2.0 * trace[i] * loss - (1.0 - loss) * slope) * stiffness;
      }
      return tau;
    }
    Pack energy(const std::array<Pack, 3>& q) const {
      return stiffness * (2.0 * strain_trace(q) + thickness.energy(1.0 + D_minus_1(q)));
    }
  };
};

using NeoHookeanSheet = RubberSheet<BlatzKoThickness>;
using NeoHookeanLogSheet = RubberSheet<LogThickness>;

}  // namespace pliant
