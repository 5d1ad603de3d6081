// Function bodies of edge_strain.h.
#pragma once

#include <cmath>

#include <Eigen/Geometry>

#include <pliant/local/shell/edge_strain.h>
#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE std::array<Mat3<double>, 3> edge_strains(const Edges<double>& e) {
  const Vec3<double> twice_area = e[0].cross(e[1]);
  const Vec3<double> normal = twice_area.normalized();
  std::array<Mat3<double>, 3> B;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3<double> t_i = e[(k + 1) % 3].cross(normal), t_j = e[(k + 2) % 3].cross(normal);
    B[k] = -(t_i * t_j.transpose() + t_j * t_i.transpose()) / (2 * twice_area.squaredNorm());
  }
  return B;
}

PLIANT_INLINE Vec3<double> edge_traces(const Edges<double>& e) {
  const double four_area2 = e[0].cross(e[1]).squaredNorm();  // (2A)^2
  return -Vec3<double>(e[1].dot(e[2]), e[2].dot(e[0]), e[0].dot(e[1])) / four_area2;
}

PLIANT_INLINE Mat3<double> edge_stiffness(const Edges<double>& e, const Sheet& sheet) {
  const double four_area2 = e[0].cross(e[1]).squaredNorm(), area = 0.5 * std::sqrt(four_area2);
  const Vec3<double> trace = edge_traces(e);
  auto dot = [&](int i, int j) {
    return e[static_cast<std::size_t>(i % 3)].dot(e[static_cast<std::size_t>(j % 3)]);
  };
  Mat3<double> S;
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) {
      // B_k : B_l = [(t_i.t_m)(t_j.t_n) + (t_i.t_n)(t_j.t_m)]/(32 A^4), where i and j are the edges other
      // than k, m and n are the edges other than l, and t_i.t_m = e_i.e_m.
      const double both = dot(k + 1, l + 1) * dot(k + 2, l + 2) + dot(k + 1, l + 2) * dot(k + 2, l + 1);
      S(k, l) = area * sheet.thickness *
                (sheet.lambda() * trace[k] * trace[l] + sheet.mu() * both / (four_area2 * four_area2));
    }
  return S;
}

}  // namespace pliant
