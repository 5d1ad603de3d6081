// The sums of Eq. (11) over the mass points of a part:
//   M = sum m G^T G            MassPointSums::add_mass()
//   g_q = -sum m G^T b         MassPointSums::add_inertial_force()
// with G = [I, -[p]x, J] and b = omega x (omega x p) + 2 omega x (J q_s_dot) + Jdot q_s_dot (inertia.h). In a
// step, only deformable parts whose s is not linear in q_s use these sums. evaluate_inertia_of(), below,
// calls evaluate_rigid_inertia() for rigid parts, and LinearInertia (linear_inertia-inl.h) for parts with s
// linear in q_s. This file also evaluates the jets of single material points.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include <pliant/math/header_only.h>
#include <pliant/part/inertia.h>
#include <pliant/part/packs.h>
#include <pliant/part/part.h>
#include <pliant/part/sum_inertia.h>

namespace pliant {

namespace detail {

/// Number of packs in a batch. The jets of a batch stay in the first-level cache.
inline constexpr int kInertiaBlock = 8;

/// The number type of four points at once. P: the number type of the parameters.
template <class P>
struct BatchScalar;
template <>
struct BatchScalar<double> {
  using Type = Pack;
  static double sum_lanes(const Pack& x) { return sum(x); }
  static double lane(const Pack& x, int i) { return x[i]; }
};
template <>
struct BatchScalar<Dual<1>> {
  using Type = Dual<1, Pack>;
  static Dual<1> sum_lanes(const Type& x) {
    Dual<1> r(sum(x.v));
    r.d[0] = sum(x.d[0]);
    return r;
  }
  static Dual<1> lane(const Type& x, int i) {
    Dual<1> r(x.v[i]);
    r.d[0] = x.d[0][i];
    return r;
  }
};

inline bool is_exactly_zero(const double& x) {
  return x == 0;
}
inline bool is_exactly_zero(const Dual<1>& x) {
  return x.v == 0 && x.d[0] == 0;
}
template <class V>
bool all_exactly_zero(const V& x) {
  for (Eigen::Index i = 0; i < x.size(); ++i)
    if (!is_exactly_zero(x[i])) return false;
  return true;
}

/// Returns the level of jets that M and g_q need for n_s dynamic parameters. rates: whether q_s_dot is not
/// zero.
inline Level inertia_level(int n_s, bool rates) {
  return rates ? Level::rates : (n_s > 0 ? Level::jacobian : Level::position);
}

/// Sums over mass points for n_s dynamic parameters. Each sum has four lanes, one for each point of a pack.
/// S: Pack, or Dual<1, Pack>.
template <class S>
struct MassPointSums {
  int n_s;
  Pack mass = Pack(0.0);
  // Entries of M: sums of m p, of m p p^T, of m J, of m p x J and of m J^T J (lower triangle, by rows).
  Vec3<S> p;
  S xx, yy, zz, xy, yz, zx;
  std::array<Vec3<S>, kMaxGlobal> J, pxJ;
  std::array<S, kMaxGlobal*(kMaxGlobal + 1) / 2> JJ;
  // Entries of -g_q: sums of m b, of m p x b and of m J^T b.
  Vec3<S> b, pxb;
  std::array<S, kMaxGlobal> Jb;

  explicit MassPointSums(int n) : n_s(n) {
    const S zero(0.0);
    p.setConstant(zero);
    b.setConstant(zero);
    pxb.setConstant(zero);
    xx = yy = zz = xy = yz = zx = zero;
    for (int c = 0, at = 0; c < n; ++c) {
      const auto k = static_cast<std::size_t>(c);
      J[k].setConstant(zero);
      pxJ[k].setConstant(zero);
      Jb[k] = zero;
      for (int d = 0; d <= c; ++d) JJ[static_cast<std::size_t>(at++)] = zero;
    }
  }

  /// Adds m G^T G of four mass points to the sums of M, Eq. (11).
  void add_mass(const Jet<S>& jet, const Pack& m) {
    mass += m;
    const Vec3<S>& s = jet.s;
    const Vec3<S> ms{s[0] * m, s[1] * m, s[2] * m};
    for (int r = 0; r < 3; ++r) p[r] += ms[r];
    xx += ms[0] * s[0];
    yy += ms[1] * s[1];
    zz += ms[2] * s[2];
    xy += ms[0] * s[1];
    yz += ms[1] * s[2];
    zx += ms[2] * s[0];
    std::size_t at = 0;
    for (int c = 0; c < n_s; ++c) {
      const auto k = static_cast<std::size_t>(c);
      const Vec3<S>& Jc = jet.J[k];
      const Vec3<S> mJ{Jc[0] * m, Jc[1] * m, Jc[2] * m};
      const Vec3<S> s_x_mJ = s.cross(mJ);
      for (int r = 0; r < 3; ++r) {
        J[k][r] += mJ[r];
        pxJ[k][r] += s_x_mJ[r];
      }
      for (int d = 0; d <= c; ++d) JJ[at++] += mJ.dot(jet.J[static_cast<std::size_t>(d)]);
    }
  }

  /// Adds m G^T b of four mass points to the sums of -g_q, Eq. (11). b is the acceleration of a mass point if
  /// all generalised accelerations are zero. rates: whether q_s_dot is not zero.
  void add_inertial_force(const Jet<S>& jet, const Pack& m, const Vec3<S>& omega, bool rates) {
    Vec3<S> acceleration = omega.cross(omega.cross(jet.s));
    if (rates) {
      const Vec3<S> half_coriolis = omega.cross(jet.s1);
      for (int r = 0; r < 3; ++r) acceleration[r] += half_coriolis[r] * 2.0 + jet.s2[r];
    }
    const Vec3<S> force{acceleration[0] * m, acceleration[1] * m, acceleration[2] * m};
    const Vec3<S> torque = jet.s.cross(force);
    for (int r = 0; r < 3; ++r) {
      b[r] += force[r];
      pxb[r] += torque[r];
    }
    for (int c = 0; c < n_s; ++c)
      Jb[static_cast<std::size_t>(c)] += jet.J[static_cast<std::size_t>(c)].dot(force);
  }
};

/// Writes the mass, the first moment and M from the sums.
template <class P, class S>
void write_mass_matrix(const MassPointSums<S>& sums, Inertia<P>& out) {
  const int n = sums.n_s;
  auto total = [](const S& x) { return BatchScalar<P>::sum_lanes(x); };
  for (int r = 0; r < 3; ++r) out.moment[r] = total(sums.p[r]);
  out.mass = sum(sums.mass);
  out.M.resize(6 + n, 6 + n);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out.M(i, j) = P(i == j ? out.mass : 0.0);
  const Vec3<P>& s = out.moment;
  const P zero(0.0), xx = total(sums.xx), yy = total(sums.yy), zz = total(sums.zz), xy = total(sums.xy),
                     yz = total(sums.yz), zx = total(sums.zx);
  // The block of (c, omega) is -[sum m p]x.
  const P M_cw[3][3] = {{zero, s[2], -s[1]}, {-s[2], zero, s[0]}, {s[1], -s[0], zero}};
  const P M_ww[3][3] = {{yy + zz, -xy, -zx}, {-xy, xx + zz, -yz}, {-zx, -yz, xx + yy}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      out.M(i, 3 + j) = out.M(3 + j, i) = M_cw[i][j];
      out.M(3 + i, 3 + j) = M_ww[i][j];
    }
  std::size_t at = 0;
  for (int c = 0; c < n; ++c) {
    const auto k = static_cast<std::size_t>(c);
    for (int r = 0; r < 3; ++r) {
      out.M(r, 6 + c) = out.M(6 + c, r) = total(sums.J[k][r]);
      out.M(3 + r, 6 + c) = out.M(6 + c, 3 + r) = total(sums.pxJ[k][r]);
    }
    for (int d = 0; d <= c; ++d) out.M(6 + c, 6 + d) = out.M(6 + d, 6 + c) = total(sums.JJ[at++]);
  }
}

/// Writes g_q from the sums.
template <class P, class S>
void write_inertial_forces(const MassPointSums<S>& sums, Inertia<P>& out) {
  auto total = [](const S& x) { return BatchScalar<P>::sum_lanes(x); };
  for (int r = 0; r < 3; ++r) {
    out.g_q[r] = -total(sums.b[r]);
    out.g_q[3 + r] = -total(sums.pxb[r]);
  }
  for (int c = 0; c < sums.n_s; ++c)
    out.g_q[6 + c] = -total(sums.Jb[static_cast<std::size_t>(c)]);  // Eq. (11)
}

/// The arguments of the inertia of a part: dynamic parameters, their rates and the angular velocity.
template <class P>
struct PartMotion {
  const VecMax<P>& q_s;
  const VecMax<P>& q_s_dot;
  const Vec3<P>& omega;
};

/// Computes M and g_q over the given mass points, Eq. (11).
template <class P>
void sum_over_mass_points(const PartEvaluation& part, const MassPoints& points, const PartMotion<P>& motion,
                          Inertia<P>& out, Counters& counters) {
  using S = typename BatchScalar<P>::Type;
  const int n = static_cast<int>(motion.q_s.size());
  const bool rates = !all_exactly_zero(motion.q_s_dot);
  const bool moving = rates || !all_exactly_zero(motion.omega);
  const ParameterValues<P> values = part.parameters().template expand<P>(motion.q_s, motion.q_s_dot);
  const Vec3<S> omega{S(motion.omega[0]), S(motion.omega[1]), S(motion.omega[2])};

  MassPointSums<S> sums(n);
  std::array<Jet<S>, kInertiaBlock> jets;
  const int n_packs = static_cast<int>(points.at.size());
  for (int first = 0; first < n_packs; first += kInertiaBlock) {
    const int count = std::min(kInertiaBlock, n_packs - first);
    JetBatch<S> batch{jets.data(), count, 0, inertia_level(n, rates)};
    part.jets(values, points.at.data() + first, batch);
    for (int i = 0; i < count; ++i) {
      const Pack& m = points.mass[static_cast<std::size_t>(first + i)];
      const Jet<S>& jet = jets[static_cast<std::size_t>(i)];
      sums.add_mass(jet, m);
      if (moving) sums.add_inertial_force(jet, m, omega, rates);
    }
  }
  ++counters.mass_matrices;
  counters.inertial_forces += moving ? 1 : 0;
  counters.jacobian_points += n > 0 ? points.n_points : 0;
  counters.rate_points += rates ? points.n_points : 0;

  write_mass_matrix(sums, out);
  out.g_q.resize(6 + n);
  if (moving)
    write_inertial_forces(sums, out);
  else
    out.g_q.setConstant(P(0.0));
}

/// Computes g_q of a rigid part. constant: M and the first moment of this part.
template <class P>
void gyroscopic_force(const Inertia<P>& constant, const Vec3<P>& omega, VecX<P>& g_q, Counters& counters) {
  g_q.resize(6);
  if (all_exactly_zero(omega)) {
    g_q.setConstant(P(0.0));
    return;
  }
  ++counters.inertial_forces;
  const Vec3<P> centripetal = omega.cross(omega.cross(constant.moment));
  Vec3<P> L;
  for (int i = 0; i < 3; ++i) {
    L[i] = P(0.0);
    for (int j = 0; j < 3; ++j) L[i] += omega[j] * constant.M(3 + i, 3 + j);
  }
  const Vec3<P> gyroscopic = omega.cross(L);
  for (int r = 0; r < 3; ++r) {
    g_q[r] = -centripetal[r];
    g_q[3 + r] = -gyroscopic[r];
  }
}

/// Computes M and g_q of a rigid part from its inertia at rest.
template <class P>
void evaluate_rigid_inertia(const Inertia<double>& rest, const Vec3<P>& omega, Inertia<P>& out,
                            Counters& counters) {
  out.mass = rest.mass;
  out.M = rest.M.template cast<P>();
  out.moment = rest.moment.template cast<P>();
  gyroscopic_force(out, omega, out.g_q, counters);
}

/// Copies one lane of a jet to a point. Without rates, p1 and p2 are set to zero.
template <class P, class S>
void read_lane(const Jet<S>& jet, int lane, int n_s, bool rates, PointJet<P>& point) {
  using Batch = BatchScalar<P>;
  point.J.resize(3, n_s);
  for (int r = 0; r < 3; ++r) {
    point.p[r] = Batch::lane(jet.s[r], lane);
    point.p1[r] = rates ? Batch::lane(jet.s1[r], lane) : P(0.0);
    point.p2[r] = rates ? Batch::lane(jet.s2[r], lane) : P(0.0);
    for (int c = 0; c < n_s; ++c) point.J(r, c) = Batch::lane(jet.J[static_cast<std::size_t>(c)][r], lane);
  }
}

/// Computes the jets of any material points, for forces, joints and tracks (recorded paths of points).
template <class P>
void evaluate_points(const PartEvaluation& part, const std::vector<Material<double>>& at,
                     const VecMax<P>& q_s, const VecMax<P>& q_s_dot, std::vector<PointJet<P>>& out,
                     Counters& counters) {
  using S = typename BatchScalar<P>::Type;
  const int n = static_cast<int>(q_s.size());
  const bool rates = !all_exactly_zero(q_s_dot);
  const ParameterValues<P> values = part.parameters().template expand<P>(q_s, q_s_dot);
  out.resize(at.size());
  counters.point_jets += static_cast<long>(at.size());
  Jet<S> jet;
  for (std::size_t first = 0; first < at.size(); first += Pack::kLanes) {
    const Material<Pack> material = pack_at(at, first);
    JetBatch<S> batch{&jet, 1, 0, inertia_level(n, rates)};
    part.jets(values, &material, batch);
    for (std::size_t i = first; i < std::min(first + Pack::kLanes, at.size()); ++i)
      read_lane(jet, static_cast<int>(i - first), n, rates, out[i]);
  }
}

}  // namespace detail

PLIANT_INLINE void sum_inertia(const Part& part, const MassPoints& points, const VecMax<double>& q_s,
                               const VecMax<double>& q_s_dot, const Vec3<double>& omega, Inertia<double>& out,
                               Counters& counters) {
  detail::sum_over_mass_points<double>(part, points, {q_s, q_s_dot, omega}, out, counters);
}

PLIANT_INLINE LinearInertia make_linear_inertia(const Part& part, const MassPoints& points) {
  const int n = part.parameters().n_dynamic();
  const VecMax<double> zero = VecMax<double>::Zero(n);
  const ParameterValues<double> values = part.parameters().expand<double>(zero, zero);
  LinearInertia moments(n);
  Jet<Pack> jet;
  Eigen::Matrix3Xd s(3, 1 + n);
  for (std::size_t i = 0; i < points.at.size(); ++i) {
    JetBatch<Pack> batch{&jet, 1, 0, Level::jacobian};
    part.jets(values, &points.at[i], batch);
    for (int lane = 0; lane < static_cast<int>(Pack::kLanes); ++lane) {
      for (int r = 0; r < 3; ++r) {
        s(r, 0) = jet.s[r][lane];
        for (int k = 0; k < n; ++k) s(r, 1 + k) = jet.J[static_cast<std::size_t>(k)][r][lane];
      }
      moments.add(s, points.mass[i][lane]);
    }
  }
  return moments;
}

template <class P>
void PartEvaluation::evaluate_inertia_of(const VecMax<P>& q_s, const VecMax<P>& q_s_dot, const Vec3<P>& omega,
                                         Inertia<P>& out, Counters& counters) const {
  if (rigid()) return detail::evaluate_rigid_inertia<P>(constants_->rest_inertia, omega, out, counters);
  if (!constants_->linear_inertia)
    return detail::sum_over_mass_points<P>(*this, constants_->mass_points, {q_s, q_s_dot, omega}, out,
                                           counters);
  constants_->linear_inertia->evaluate(q_s, q_s_dot, omega, out);
  ++counters.mass_matrices;
  counters.inertial_forces += detail::all_exactly_zero(q_s_dot) && detail::all_exactly_zero(omega) ? 0 : 1;
}

PLIANT_INLINE void PartEvaluation::evaluate_inertia(const VecMax<double>& q_s, const VecMax<double>& q_s_dot,
                                                    const Vec3<double>& omega, Inertia<double>& out,
                                                    Counters& counters) const {
  evaluate_inertia_of(q_s, q_s_dot, omega, out, counters);
}
PLIANT_INLINE void PartEvaluation::evaluate_inertia(const VecMax<Dual<1>>& q_s,
                                                    const VecMax<Dual<1>>& q_s_dot,
                                                    const Vec3<Dual<1>>& omega, Inertia<Dual<1>>& out,
                                                    Counters& counters) const {
  evaluate_inertia_of(q_s, q_s_dot, omega, out, counters);
}
PLIANT_INLINE void PartEvaluation::rigid_force(const Inertia<double>& constant, const Vec3<double>& omega,
                                               VecX<double>& g_q, Counters& counters) {
  detail::gyroscopic_force<double>(constant, omega, g_q, counters);
}

PLIANT_INLINE void PartEvaluation::points(const std::vector<Material<double>>& at, const VecMax<double>& q_s,
                                          const VecMax<double>& q_s_dot, std::vector<PointJet<double>>& out,
                                          Counters& counters) const {
  detail::evaluate_points<double>(*this, at, q_s, q_s_dot, out, counters);
}
PLIANT_INLINE void PartEvaluation::points(const std::vector<Material<double>>& at, const VecMax<Dual<1>>& q_s,
                                          const VecMax<Dual<1>>& q_s_dot, std::vector<PointJet<Dual<1>>>& out,
                                          Counters& counters) const {
  detail::evaluate_points<Dual<1>>(*this, at, q_s, q_s_dot, out, counters);
}

}  // namespace pliant
