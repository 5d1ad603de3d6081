// The strain of a triangle told by its edges (natural strains, Argyris 1964). Edge k, opposite corner k, runs
// e_k = x_(k+2) - x_(k+1); with the strain eps in the plane of the triangle at rest
//   q_k = e_k . eps e_k,   eps = sum q_k B_k,   B_k = -(t_i t_j + t_j t_i)/(8 A^2),   t_k = e_k turned by 90
//   deg.
// Small displacements make q_k = e_k . (d_(k+2) - d_(k+1)), finite ones q_k = (|e_k|^2 - |e_k|_rest^2)/2: the
// energy W(q) pushes with tensions tau_k = dW/dq_k along e_k, and motions of rigid bodies strain nothing.
#pragma once

#include <array>

#include <pliant/local/shell/sheet.h>
#include <pliant/local/shell/shell_mesh.h>
#include <pliant/local/solid/element_batches.h>

namespace pliant {

template <class T>
using Edges = std::array<Vec3<T>, 3>;

template <class T>
Edges<T> edges_of(const std::array<Vec3<T>, 3>& x) {
  return {x[2] - x[1], x[0] - x[2], x[1] - x[0]};
}
inline Edges<double> edges_of(const ShellMesh& mesh, Eigen::Index t) {
  return edges_of<double>({mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)});
}

/// How q changes while the edges e change by de.
template <class T>
std::array<T, 3> strain_change(const Edges<T>& e, const Edges<T>& de) {
  return {e[0].dot(de[0]), e[1].dot(de[1]), e[2].dot(de[2])};
}
/// |e_k|^2/2.
template <class T>
std::array<T, 3> half_squares(const Edges<T>& e) {
  return {0.5 * e[0].dot(e[0]), 0.5 * e[1].dot(e[1]), 0.5 * e[2].dot(e[2])};
}

/// B_k.
std::array<Mat3<double>, 3> edge_strains(const Edges<double>& e);
/// tr B_k, 1/m^2.
Vec3<double> edge_traces(const Edges<double>& e);
/// S of the energy 1/2 q S q of a triangle of the sheet, N/m^3.
Mat3<double> edge_stiffness(const Edges<double>& e, const Sheet& sheet);

/// What tensions tau along e push at the corners.
template <class T>
std::array<Vec3<T>, 3> corner_forces(const std::array<T, 3>& tau, const Edges<T>& e) {
  const Vec3<T> a = tau[0] * e[0], b = tau[1] * e[1], c = tau[2] * e[2];
  return {c - b, a - c, b - a};
}

}  // namespace pliant
