#include <pliant/part/inertia.h>

#include <pliant/part/part.h>
#include <pliant/part/sum_inertia.h>

namespace pliant {

namespace {

/// Packs handled at a time: their jets stay in the first-level cache.
constexpr int kBlock = 8;

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

template <class P>
bool is_zero(const P& x);
template <>
bool is_zero(const double& x) {
  return x == 0;
}
template <>
bool is_zero(const Dual<1>& x) {
  return x.v == 0 && x.d[0] == 0;
}
template <class V>
bool all_zero(const V& x) {
  for (Eigen::Index i = 0; i < x.size(); ++i)
    if (!is_zero(x[i])) return false;
  return true;
}

/// Sums over mass points, four lanes wide.
template <class S>
struct Sums {
  Vec3<S> p, b, pxb;
  S xx, yy, zz, xy, yz, zx;
  std::array<Vec3<S>, kMaxGlobal> J, pxJ;
  std::array<S, kMaxGlobal> Jb;
  std::array<S, kMaxGlobal*(kMaxGlobal + 1) / 2> JJ;

  explicit Sums(int n) {
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

  void add_mass(const Jet<S>& jet, const Pack& m, int n) {
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
    for (int c = 0; c < n; ++c) {
      const auto k = static_cast<std::size_t>(c);
      const Vec3<S>& Jc = jet.J[k];
      const Vec3<S> mJ{Jc[0] * m, Jc[1] * m, Jc[2] * m};
      const Vec3<S> turn = s.cross(mJ);
      for (int r = 0; r < 3; ++r) {
        J[k][r] += mJ[r];
        pxJ[k][r] += turn[r];
      }
      for (int d = 0; d <= c; ++d) JJ[at++] += mJ.dot(jet.J[static_cast<std::size_t>(d)]);
    }
  }

  void add_inertial_force(const Jet<S>& jet, const Pack& m, int n, const Vec3<S>& omega, bool rates) {
    Vec3<S> acceleration = omega.cross(omega.cross(jet.s));
    if (rates) {
      const Vec3<S> coriolis = omega.cross(jet.s1);
      for (int r = 0; r < 3; ++r) acceleration[r] += coriolis[r] * 2.0 + jet.s2[r];
    }
    const Vec3<S> force{acceleration[0] * m, acceleration[1] * m, acceleration[2] * m};
    const Vec3<S> torque = jet.s.cross(force);
    for (int r = 0; r < 3; ++r) {
      b[r] += force[r];
      pxb[r] += torque[r];
    }
    for (int c = 0; c < n; ++c)
      Jb[static_cast<std::size_t>(c)] += jet.J[static_cast<std::size_t>(c)].dot(force);
  }
};

template <class P>
void fill_rigid_blocks(Inertia<P>& out, int n, double mass, const P& xx, const P& yy, const P& zz,
                       const P& xy, const P& yz, const P& zx) {
  out.mass = mass;
  out.M.resize(6 + n, 6 + n);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out.M(i, j) = P(i == j ? mass : 0.0);
  const Vec3<P>& s = out.moment;
  const P zero(0.0);
  // M_comega = -[sum m p]x
  const P M_cw[3][3] = {{zero, s[2], -s[1]}, {-s[2], zero, s[0]}, {s[1], -s[0], zero}};
  const P M_ww[3][3] = {{yy + zz, -xy, -zx}, {-xy, xx + zz, -yz}, {-zx, -yz, xx + yy}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      out.M(i, 3 + j) = out.M(3 + j, i) = M_cw[i][j];
      out.M(3 + i, 3 + j) = M_ww[i][j];
    }
}

template <class P>
void sum_over(const Part& part, const MassPoints& points, const VecMax<P>& q_s, const VecMax<P>& q_s_dot,
              const Vec3<P>& omega, Inertia<P>& out, Counters& counters) {
  using Batch = BatchScalar<P>;
  using S = typename Batch::Type;
  const int n = static_cast<int>(q_s.size());
  const bool rates = !all_zero(q_s_dot);
  const bool moving = rates || !all_zero(omega);
  const ParameterValues<P> values = part.parameters().expand<P>(q_s, q_s_dot);
  const Level level = rates ? Level::rates : (n > 0 ? Level::jacobian : Level::position);
  const Vec3<S> turning{S(omega[0]), S(omega[1]), S(omega[2])};

  Sums<S> sums(n);
  Pack mass(0.0);
  std::array<Jet<S>, kBlock> jets;
  const int n_packs = static_cast<int>(points.at.size());
  for (int first = 0; first < n_packs; first += kBlock) {
    const int count = std::min(kBlock, n_packs - first);
    JetBatch<S> batch{jets.data(), count, 0, level};
    part.jets(values, points.at.data() + first, batch);
    for (int i = 0; i < count; ++i) {
      const Pack& m = points.mass[static_cast<std::size_t>(first + i)];
      const Jet<S>& jet = jets[static_cast<std::size_t>(i)];
      mass += m;
      sums.add_mass(jet, m, n);
      if (moving) sums.add_inertial_force(jet, m, n, turning, rates);
    }
  }
  ++counters.mass_matrices;
  counters.inertial_forces += moving ? 1 : 0;
  counters.jacobian_points += n > 0 ? points.n_points : 0;
  counters.rate_points += rates ? points.n_points : 0;

  auto total = [](const S& x) { return Batch::sum_lanes(x); };
  for (int r = 0; r < 3; ++r) out.moment[r] = total(sums.p[r]);
  fill_rigid_blocks<P>(out, n, sum(mass), total(sums.xx), total(sums.yy), total(sums.zz), total(sums.xy),
                       total(sums.yz), total(sums.zx));
  std::size_t at = 0;
  for (int c = 0; c < n; ++c) {
    const auto k = static_cast<std::size_t>(c);
    for (int r = 0; r < 3; ++r) {
      out.M(r, 6 + c) = out.M(6 + c, r) = total(sums.J[k][r]);
      out.M(3 + r, 6 + c) = out.M(6 + c, 3 + r) = total(sums.pxJ[k][r]);
    }
    for (int d = 0; d <= c; ++d) out.M(6 + c, 6 + d) = out.M(6 + d, 6 + c) = total(sums.JJ[at++]);
  }
  out.g_q.resize(6 + n);
  if (!moving) {
    out.g_q.setConstant(P(0.0));
    return;
  }
  for (int r = 0; r < 3; ++r) {
    out.g_q[r] = -total(sums.b[r]);
    out.g_q[3 + r] = -total(sums.pxb[r]);
  }
  for (int c = 0; c < n; ++c) out.g_q[6 + c] = -total(sums.Jb[static_cast<std::size_t>(c)]);  // Eq. (11)
}

/// The gyroscopic force of a rigid part; everything else is constant.
template <class P>
void gyroscopic_force(const Vec3<P>& omega, Inertia<P>& out, Counters& counters) {
  out.g_q.resize(6);
  if (all_zero(omega)) {
    out.g_q.setConstant(P(0.0));
    return;
  }
  ++counters.inertial_forces;
  const Vec3<P> centripetal = omega.cross(omega.cross(out.moment));
  Vec3<P> L;
  for (int i = 0; i < 3; ++i) {
    L[i] = P(0.0);
    for (int j = 0; j < 3; ++j) L[i] += omega[j] * out.M(3 + i, 3 + j);
  }
  const Vec3<P> gyroscopic = omega.cross(L);
  for (int r = 0; r < 3; ++r) {
    out.g_q[r] = -centripetal[r];
    out.g_q[3 + r] = -gyroscopic[r];
  }
}

template <class P>
void rigid_inertia(const Inertia<double>& rest, const Vec3<P>& omega, Inertia<P>& out, Counters& counters) {
  out.mass = rest.mass;
  out.M = rest.M.cast<P>();
  out.moment = rest.moment.cast<P>();
  gyroscopic_force(omega, out, counters);
}

template <class P>
void point_jets(const Part& part, const std::vector<Material<double>>& at, const VecMax<P>& q_s,
                const VecMax<P>& q_s_dot, std::vector<PointJet<P>>& out, Counters& counters) {
  using Batch = BatchScalar<P>;
  using S = typename Batch::Type;
  const int n = static_cast<int>(q_s.size());
  const bool rates = !all_zero(q_s_dot);
  const ParameterValues<P> values = part.parameters().expand<P>(q_s, q_s_dot);
  const Level level = rates ? Level::rates : (n > 0 ? Level::jacobian : Level::position);
  out.resize(at.size());
  counters.point_jets += static_cast<long>(at.size());
  Jet<S> jet;
  for (std::size_t first = 0; first < at.size(); first += Pack::kLanes) {
    std::array<Material<double>, Pack::kLanes> four;
    for (std::size_t i = 0; i < Pack::kLanes; ++i) four[i] = at[std::min(first + i, at.size() - 1)];
    const Material<Pack> material = gather(four.data());
    JetBatch<S> batch{&jet, 1, 0, level};
    part.jets(values, &material, batch);
    for (std::size_t i = first; i < std::min(first + Pack::kLanes, at.size()); ++i) {
      const int lane = static_cast<int>(i - first);
      PointJet<P>& point = out[i];
      point.J.resize(3, n);
      for (int r = 0; r < 3; ++r) {
        point.p[r] = Batch::lane(jet.s[r], lane);
        point.p1[r] = rates ? Batch::lane(jet.s1[r], lane) : P(0.0);
        point.p2[r] = rates ? Batch::lane(jet.s2[r], lane) : P(0.0);
        for (int c = 0; c < n; ++c) point.J(r, c) = Batch::lane(jet.J[static_cast<std::size_t>(c)][r], lane);
      }
    }
  }
}

}  // namespace

Counters& Counters::operator+=(const Counters& o) {
  jacobian_points += o.jacobian_points;
  rate_points += o.rate_points;
  mass_matrices += o.mass_matrices;
  inertial_forces += o.inertial_forces;
  point_jets += o.point_jets;
  surfaces += o.surfaces;
  strain_points += o.strain_points;
  return *this;
}

void sum_inertia(const Part& part, const MassPoints& points, const VecMax<double>& q_s,
                 const VecMax<double>& q_s_dot, const Vec3<double>& omega, Inertia<double>& out,
                 Counters& counters) {
  sum_over<double>(part, points, q_s, q_s_dot, omega, out, counters);
}

LinearInertia make_linear_inertia(const Part& part, const MassPoints& points) {
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
void Part::moving_inertia(const VecMax<P>& q_s, const VecMax<P>& q_s_dot, const Vec3<P>& omega,
                          Inertia<P>& out, Counters& counters) const {
  if (rigid()) return rigid_inertia<P>(rest_inertia_, omega, out, counters);
  if (!linear_inertia_) return sum_over<P>(*this, mass_points_, q_s, q_s_dot, omega, out, counters);
  linear_inertia_->inertia(q_s, q_s_dot, omega, out);
  ++counters.mass_matrices;
  counters.inertial_forces += all_zero(q_s_dot) && all_zero(omega) ? 0 : 1;
}

void Part::inertia(const VecMax<double>& q_s, const VecMax<double>& q_s_dot, const Vec3<double>& omega,
                   Inertia<double>& out, Counters& counters) const {
  moving_inertia(q_s, q_s_dot, omega, out, counters);
}
void Part::rigid_force(const Vec3<double>& omega, Inertia<double>& out, Counters& counters) {
  gyroscopic_force<double>(omega, out, counters);
}
void Part::inertia(const VecMax<Dual<1>>& q_s, const VecMax<Dual<1>>& q_s_dot, const Vec3<Dual<1>>& omega,
                   Inertia<Dual<1>>& out, Counters& counters) const {
  moving_inertia(q_s, q_s_dot, omega, out, counters);
}

void Part::points(const std::vector<Material<double>>& at, const VecMax<double>& q_s,
                  const VecMax<double>& q_s_dot, std::vector<PointJet<double>>& out,
                  Counters& counters) const {
  point_jets<double>(*this, at, q_s, q_s_dot, out, counters);
}
void Part::points(const std::vector<Material<double>>& at, const VecMax<Dual<1>>& q_s,
                  const VecMax<Dual<1>>& q_s_dot, std::vector<PointJet<Dual<1>>>& out,
                  Counters& counters) const {
  point_jets<Dual<1>>(*this, at, q_s, q_s_dot, out, counters);
}

}  // namespace pliant
