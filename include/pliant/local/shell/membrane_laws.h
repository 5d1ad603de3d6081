// Material laws of membranes that deform by any amount, as energies W(q) of a triangle, J, with q the half
// changes of its squared edges (edge_strain.h). With Green's strain G = sum q_k B_k, C = 1 + 2 G:
//   St. Venant-Kirchhoff   W = A t [lambda/2 (tr G)^2 + mu G:G] = 1/2 q S q
//   neo-Hookean            W = A t mu/2 [tr C - 2 + (D^-k - 1)/k],  D = det C,  k = nu/(1 - nu)
// The second is the compressible material of Blatz & Ko (1962) with the thickness that plane stress gives,
// which is D^(-k/2) times that at rest; k = 1 is incompressible rubber; k -> 0 leaves -log D.
#pragma once

#include <array>

#include <Eigen/Geometry>

#include <pliant/local/shell/edge_strain.h>

namespace pliant {

struct StVenantKirchhoffSheet {
  static constexpr const char* name = "st_venant_kirchhoff";

  /// Constants of four triangles.
  struct Triangles {
    std::array<Pack, 3> diagonal, off;  ///< S_00 S_11 S_22, S_12 S_20 S_01

    void set(int lane, const Edges<double>& e, const Sheet& sheet) {
      const Mat3<double> S = edge_stiffness(e, sheet);
      for (int k = 0; k < 3; ++k) {
        diagonal[static_cast<std::size_t>(k)].set(lane, S(k, k));
        off[static_cast<std::size_t>(k)].set(lane, S((k + 1) % 3, (k + 2) % 3));
      }
    }
    template <class T>
    std::array<T, 3> tension(const std::array<T, 3>& q) const {
      std::array<T, 3> tau;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        tau[k] = q[k] * diagonal[k] + q[i] * off[j] + q[j] * off[i];
      }
      return tau;
    }
    /// As far as strains are small.
    std::array<Pack, 3> linear_tension(const std::array<Pack, 3>& q) const { return tension(q); }
    Pack energy(const std::array<Pack, 3>& q) const {
      const std::array<Pack, 3> tau = tension(q);
      return 0.5 * (q[0] * tau[0] + q[1] * tau[1] + q[2] * tau[2]);
    }
  };
};

struct NeoHookeanSheet {
  static constexpr const char* name = "neo_hookean";

  struct Triangles {
    std::array<Pack, 3> trace;  ///< tr B_k
    Pack inverse;               ///< 1/(2A)^2
    Pack stiffness;             ///< A t mu / 2
    double k = 0;
    StVenantKirchhoffSheet::Triangles small;  ///< the same material, as far as strains are small

    void set(int lane, const Edges<double>& e, const Sheet& sheet) {
      const Vec3<double> tr = edge_traces(e);
      for (int i = 0; i < 3; ++i) trace[static_cast<std::size_t>(i)].set(lane, tr[i]);
      const double twice_area = e[0].cross(e[1]).norm();
      inverse.set(lane, 1 / (twice_area * twice_area));
      stiffness.set(lane, 0.25 * twice_area * sheet.thickness * sheet.mu());
      k = sheet.nu / (1 - sheet.nu);
      small.set(lane, e, sheet);
    }
    std::array<Pack, 3> linear_tension(const std::array<Pack, 3>& q) const { return small.tension(q); }
    template <class T>
    T trace_of(const std::array<T, 3>& q) const {
      return q[0] * trace[0] + q[1] * trace[1] + q[2] * trace[2];
    }
    /// D - 1 = 2 tr G + 4 det G, by Heron's formula for the second.
    template <class T>
    T stretch_of(const std::array<T, 3>& q) const {
      const T det = q[0] * (q[1] + q[1] - q[0]) + q[1] * (q[2] + q[2] - q[1]) + q[2] * (q[0] + q[0] - q[2]);
      return 2.0 * trace_of(q) + det * inverse;
    }
    template <class T>
    std::array<T, 3> tension(const std::array<T, 3>& q) const {
      // dW = stiffness (2 tr dG - D^(-k-1) dD), each as its own small difference from rest.
      const T D = 1.0 + stretch_of(q);
      const T rise = 1.0 - power(D);
      std::array<T, 3> tau;
      for (std::size_t i = 0; i < 3; ++i) {
        const T slope = 2.0 * (q[(i + 1) % 3] + q[(i + 2) % 3] - q[i]) * inverse;  // d(4 det G)/dq_i
        tau[i] = (2.0 * trace[i] * rise - (1.0 - rise) * slope) * stiffness;
      }
      return tau;
    }
    Pack energy(const std::array<Pack, 3>& q) const {
      const Pack D = 1.0 + stretch_of(q);
      const Pack squeeze = k == 0 ? -log(D) : (D * power(D) - 1.0) / k;
      return stiffness * (2.0 * trace_of(q) + squeeze);
    }

   private:
    /// D^(-k-1).
    template <class T>
    T power(const T& D) const {
      if (k == 1) return 1.0 / (D * D);
      if (k == 0) return 1.0 / D;
      return math::exp(T(-(k + 1) * math::log(D)));
    }
  };
};

}  // namespace pliant
