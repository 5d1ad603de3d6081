// Strain of a triangle from the change of its edges (natural strains, Argyris 1964). Edge k is opposite
// corner k, e_k = x_(k+2) - x_(k+1), with indices modulo 3. q_k (m^2) measures the change of edge k. For a
// strain eps in the plane of the triangle at rest,
//   q_k = e_k . eps e_k,   eps = sum_k q_k B_k,   B_k = -(t_i t_j^T + t_j t_i^T)/(8 A^2),
// with i, j the other two edges, t_k = e_k rotated by 90 degrees in the plane and A the area.
//   small displacements    q_k = e_k . (d_(k+2) - d_(k+1))
//   finite displacements   q_k = (|e_k|^2 - |e_k|_rest^2)/2, from Green's strain
// An energy W(q) pulls the two ends of edge k together with the force tau_k e_k, where tau_k = dW/dq_k is the
// tension (N/m). Rigid motion leaves q = 0 (to first order for small displacements).
#pragma once

#include <array>

#include <pliant/local/shell/sheet.h>
#include <pliant/local/shell/shell_mesh.h>
#include <pliant/local/solid/element_batches.h>

namespace pliant {

/// Edge vectors e_0, e_1, e_2.
template <class T>
using Edges = std::array<Vec3<T>, 3>;

/// Returns the edges of a triangle with corners x, m.
template <class T>
Edges<T> edges_of(const std::array<Vec3<T>, 3>& x) {
  return {x[2] - x[1], x[0] - x[2], x[1] - x[0]};
}
/// Returns the edges of triangle t at rest, m.
inline Edges<double> edges_of(const ShellMesh& mesh, Eigen::Index t) {
  return edges_of<double>({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)});
}

/// Returns the change of q, m^2, to first order when the edges e change by de.
template <class T>
std::array<T, 3> strain_change(const Edges<T>& e, const Edges<T>& de) {
  return {e[0].dot(de[0]), e[1].dot(de[1]), e[2].dot(de[2])};
}
/// Returns |e_k|^2/2, m^2.
template <class T>
std::array<T, 3> half_squares(const Edges<T>& e) {
  return {0.5 * e[0].dot(e[0]), 0.5 * e[1].dot(e[1]), 0.5 * e[2].dot(e[2])};
}

/// Returns B_0, B_1, B_2 of a triangle, 1/m^2.
std::array<Mat3<double>, 3> edge_strains(const Edges<double>& e);
/// Returns tr B_k, 1/m^2.
Vec3<double> edge_traces(const Edges<double>& e);
/// Returns S of the energy 1/2 q S q of a triangle of the sheet, N/m^3.
Mat3<double> edge_stiffness(const Edges<double>& e, const Sheet& sheet);

/// Returns the forces on corners 0, 1 and 2, N, of tensions tau (N/m) along the edges e.
template <class T>
std::array<Vec3<T>, 3> corner_forces(const std::array<T, 3>& tau, const Edges<T>& e) {
  const Vec3<T> a = tau[0] * e[0], b = tau[1] * e[1], c = tau[2] * e[2];
  return {c - b, a - c, b - a};
}

}  // namespace pliant
