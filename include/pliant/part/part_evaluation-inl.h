// Function bodies of PartEvaluation for geometry: the reference shape s, Eq. (3), gradients, normals, and the
// map from positions to material points.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <pliant/math/header_only.h>
#include <pliant/part/mesh/folds.h>
#include <pliant/part/packs.h>
#include <pliant/part/part.h>

namespace pliant {

namespace detail {

/// Where a gradient is singular at a tip of the body, the gradient is evaluated at z (1 - kBelowTip) instead.
/// A point with 1 - |z|/h <= kBelowTip is treated as a point at an end of the body. h: half height; z:
/// coordinate before the deformation.
inline constexpr double kBelowTip = 1e-9;

/// Evaluates the positions of material points, four at a time. Calls store(i, jet, lane) for each point
/// number i; lane `lane` of the jet has the position of this point. S is the scalar of the jet.
template <class S, class P, class Store>
void evaluate_positions(const PartEvaluation& part, const std::vector<Material<double>>& at,
                        const ParameterValues<P>& values, Store&& store) {
  Jet<S> jet;
  for (std::size_t first = 0; first < at.size(); first += Pack::kLanes) {
    const Material<Pack> material = pack_at(at, first);
    JetBatch<S> batch{&jet, 1, 0, Level::position};
    part.jets(values, &material, batch);
    for (std::size_t i = first; i < std::min(first + Pack::kLanes, at.size()); ++i)
      store(static_cast<Eigen::Index>(i), jet, static_cast<int>(i - first));
  }
}

/// Returns the cofactor matrix det(F) F^-T, which is finite where F is singular.
inline Mat3<double> part_cofactors(const Mat3<double>& F) {
  Mat3<double> C;
  C << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
  return C;
}
inline bool is_singular_gradient(const Mat3<double>& F) {
  return !(std::abs(F.determinant()) > 1e-13 * F.norm() * part_cofactors(F).norm());
}
inline Vec3<double> below_tip(const Vec3<double>& e) {
  return {e[0], e[1], e[2] * (1 - kBelowTip)};
}

}  // namespace detail

PLIANT_INLINE const std::shared_ptr<const PartConstants>& PartEvaluation::no_constants() {
  static const auto none = std::make_shared<const PartConstants>();
  return none;
}

PLIANT_INLINE void PartEvaluation::jets(const ParameterValues<Dual<1>>& values, const Material<Pack>* at,
                                        JetBatch<Dual<1, Pack>>& batch) const {
  constexpr int block = 8;
  std::array<Material<Dual<1, Pack>>, block> material;
  for (int first = 0; first < batch.count; first += block) {
    JetBatch<Dual<1, Pack>> some{batch.jet + first, std::min(block, batch.count - first), 0, batch.level};
    for (int i = 0; i < some.count; ++i) material[static_cast<std::size_t>(i)] = constant(at[first + i]);
    jets(values, material.data(), some);
    batch.n_columns = some.n_columns;
  }
}

PLIANT_INLINE Eigen::Matrix3Xd PartEvaluation::s(const std::vector<Material<double>>& at,
                                                 const ParameterValues<double>& values) const {
  Eigen::Matrix3Xd out(3, static_cast<Eigen::Index>(at.size()));
  detail::evaluate_positions<Pack>(*this, at, values, [&](Eigen::Index i, const Jet<Pack>& jet, int lane) {
    for (int r = 0; r < 3; ++r) out(r, i) = jet.s[r][lane];
  });
  return out;
}

PLIANT_INLINE Eigen::Matrix3Xd PartEvaluation::s_along(const std::vector<Material<double>>& at,
                                                       const ParameterValues<Dual<1>>& values) const {
  Eigen::Matrix3Xd out(3, static_cast<Eigen::Index>(at.size()));
  detail::evaluate_positions<Dual<1, Pack>>(*this, at, values,
                                            [&](Eigen::Index i, const Jet<Dual<1, Pack>>& jet, int lane) {
                                              for (int r = 0; r < 3; ++r) out(r, i) = jet.s[r].d[0][lane];
                                            });
  return out;
}

PLIANT_INLINE void PartEvaluation::apply_chain(const Eigen::Matrix<double, 3, 4>& e,
                                               const ParameterValues<double>& values,
                                               ChainImages& images) const {
  static_assert(Pack::kLanes == 4);
  Jet<Pack> jet;
  for (int r = 0; r < 3; ++r) {
    for (int i = 0; i < 4; ++i) jet.s[r].set(i, e(r, i));
    for (std::size_t c = 0; c < 3; ++c) jet.J[c][r] = Pack(static_cast<std::size_t>(r) == c ? 1.0 : 0.0);
  }
  JetBatch<Pack> batch{&jet, 1, 3, Level::jacobian};
  deform(values, batch);
  for (int i = 0; i < 4; ++i)
    for (int r = 0; r < 3; ++r) {
      images.x(r, i) = jet.s[r][i];
      for (int c = 0; c < 3; ++c)
        images.F[static_cast<std::size_t>(i)](r, c) = jet.J[static_cast<std::size_t>(c)][r][i];
    }
}

PLIANT_INLINE std::vector<Mat3<double>> PartEvaluation::chain_gradient(
    const Eigen::Matrix3Xd& e, const ParameterValues<double>& values) const {
  std::vector<Mat3<double>> F(static_cast<std::size_t>(e.cols()));
  Eigen::Matrix<double, 3, 4> four;
  ChainImages images;
  for (Eigen::Index first = 0; first < e.cols(); first += 4) {
    for (int i = 0; i < 4; ++i) four.col(i) = e.col(std::min(first + i, e.cols() - 1));
    apply_chain(four, values, images);
    for (Eigen::Index i = first; i < std::min(first + 4, e.cols()); ++i)
      F[static_cast<std::size_t>(i)] = images.F[static_cast<std::size_t>(i - first)];
  }
  return F;
}

PLIANT_INLINE Mat3<double> PartEvaluation::material_gradient(double u, double v, double w,
                                                             const ParameterValues<double>& values) const {
  const Vec3<Dual<3>> e = shape().tangents(material_with_tangents(u, v, w), values.b.data());
  Mat3<double> E;
  Eigen::Matrix3Xd at(3, 1);
  for (int r = 0; r < 3; ++r) {
    at(r, 0) = e[r].v;
    for (int c = 0; c < 3; ++c) E(r, c) = e[r].d[static_cast<std::size_t>(c)];
  }
  return chain_gradient(at, values)[0] * E;
}

PLIANT_INLINE Vec3<double> PartEvaluation::undeformed_point(const Vec3<double>& p,
                                                            const ParameterValues<double>& values) const {
  const Vec3<double> e = inverse_chain(p, values);
  const double* a = values.b.data();
  const double h = shape().half_height(a);
  if (parameters().all_links().empty() || std::abs(e[2]) < (1 - detail::kBelowTip) * h) return e;
  // p is at an end of the body. If the chain maps the whole end section to p (a tip), the pole of the shape
  // is returned, because the inverse of the chain is not unique there.
  const Vec3<double> end = shape().e(material_at(std::copysign(kPi / 2, e[2]), 0), a);
  Jet<Pack> jet;
  for (int r = 0; r < 3; ++r) jet.s[r] = Pack(end[r]);
  JetBatch<Pack> batch{&jet, 1, 0, Level::position};
  deform(values, batch);
  const Vec3<double> deformed(jet.s[0][0], jet.s[1][0], jet.s[2][0]);
  return (p - deformed).norm() <= std::min(1e-12 * h, 1e-6 * (e - end).norm()) ? end : e;
}

PLIANT_INLINE double PartEvaluation::inside_outside(const Vec3<double>& p,
                                                    const ParameterValues<double>& values) const {
  return shape().gauge(undeformed_point(p, values), values.b.data()) - 1;
}

PLIANT_INLINE Vec3<double> PartEvaluation::inside_outside_gradient(
    const Vec3<double>& p, const ParameterValues<double>& values) const {
  Vec3<double> e = undeformed_point(p, values);
  if (parameters().links().empty()) return shape().gauge_gradient(e, values.b.data());
  Mat3<double> F = chain_gradient(Eigen::Matrix3Xd(e), values)[0];
  if (detail::is_singular_gradient(F)) {
    e = detail::below_tip(e);
    F = chain_gradient(Eigen::Matrix3Xd(e), values)[0];
  }
  return F.transpose().partialPivLu().solve(shape().gauge_gradient(e, values.b.data()));
}

PLIANT_INLINE std::vector<Vec3<double>> PartEvaluation::normals(const std::vector<Material<double>>& at,
                                                                const ParameterValues<double>& values) const {
  Eigen::Matrix3Xd e(3, static_cast<Eigen::Index>(at.size()));
  for (std::size_t i = 0; i < at.size(); ++i)
    e.col(static_cast<Eigen::Index>(i)) = shape().e(at[i], values.b.data());
  const std::vector<Mat3<double>> gradients = chain_gradient(e, values);
  // Barr 1984: the normal is parallel to det(F) F^-T n_e, with the normal n_e of the undeformed shape.
  auto outward = [&](const Mat3<double>& F, const Vec3<double>& from) {
    return Vec3<double>(detail::part_cofactors(F) * shape().gauge_gradient(from, values.b.data()));
  };
  std::vector<Vec3<double>> all;
  all.reserve(at.size());
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Vec3<double> from = e.col(static_cast<Eigen::Index>(i));
    Vec3<double> n = outward(gradients[i], from);
    if (n.isZero(0)) {
      const Vec3<double> below = detail::below_tip(from);
      n = outward(chain_gradient(Eigen::Matrix3Xd(below), values)[0], below);
    }
    all.push_back(n.normalized());
  }
  return all;
}

PLIANT_INLINE Vec3<double> PartEvaluation::normal(const Material<double>& m,
                                                  const ParameterValues<double>& values) const {
  return normals({m}, values)[0];
}

PLIANT_INLINE bool PartEvaluation::is_inverted(const VecMax<double>& q_s) const {
  const VecMax<double> still = VecMax<double>::Zero(q_s.size());
  return folds(part(), parameters().expand<double>(q_s, still));
}

PLIANT_INLINE Material<double> PartEvaluation::label(const Vec3<double>& p,
                                                     const ParameterValues<double>& values) const {
  return shape().label(undeformed_point(p, values), values.b.data());
}

}  // namespace pliant
