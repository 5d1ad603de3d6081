// Function bodies of ContinuumEnergy: strain energy, force and stiffness.
#pragma once

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <type_traits>

#include <pliant/local/solid/corotated.h>
#include <pliant/math/header_only.h>
#include <pliant/part/continuum.h>
#include <pliant/part/part.h>
#include <pliant/part/quadrature/strain_rule.h>
#include <pliant/part/strain.h>

namespace pliant {

namespace detail {

using DualPack = Dual<1, Pack>;

inline DualPack dual_pack(const Pack& value, const Pack& slope) {
  DualPack x(value);
  x.d[0] = slope;
  return x;
}
inline Mat3<DualPack> dual_pack(const Mat3<Pack>& F, const Mat3<Pack>& dF) {
  Mat3<DualPack> D;
  for (int i = 0; i < 9; ++i) D.data()[i] = dual_pack(F.data()[i], dF.data()[i]);
  return D;
}
inline Dual<1> sum_of_lanes(const DualPack& x) {
  Dual<1> r(sum(x.v));
  r.d[0] = sum(x.d[0]);
  return r;
}

/// Throws InvertedElement if the material at one of four quadrature points is turned inside out. A sheet
/// cannot be turned inside out and is not checked.
template <class Law>
void throw_if_inverted(const Law&, const Mat3<Pack>& F) {
  if constexpr (!std::is_same_v<Law, SheetStrain>)
    if (!(min_lane(determinant(F, cofactors(F))) > 0))
      throw InvertedElement(
          "its global deformation turns some of its elastic material inside out; choose a stiffer material "
          "or "
          "limits (min, max) of its parameters");
}

/// Returns the values of all parameters at q_s, with zero rates.
inline strain::DualValues values_at(const Part& part, const VecMax<double>& q_s) {
  return part.parameters().expand<Dual<1>>(q_s, VecMax<double>(VecMax<double>::Zero(q_s.size())));
}

/// Calls act(first, count) for blocks of packs that cover all points.
template <class F>
void for_each_strain_block(const StrainPoints& points, F&& act) {
  const int packs = static_cast<int>(points.weight.size());
  for (int first = 0; first < packs; first += strain::kBlock)
    act(first, std::min(strain::kBlock, packs - first));
}

/// Second derivatives of F by q_s along two directions v and w, from second derivatives along one direction,
/// Q(v) = d2F[v, v]:
///   4 d2F[v, w] = Q(v + w) - Q(v - w)
class SecondStrainDerivatives {
 public:
  SecondStrainDerivatives(const Part& part, const StrainPoints& points, const VecMax<double>& q_s)
      : part_(part), points_(points), q_s_(q_s) {}
  using Matrices = std::array<Mat3<Pack>, strain::kBlock>;

  /// Computes d2F[v, v] of a block.
  void along(const VecMax<double>& v, int first, int count, Matrices& Q) const {
    const auto values = part_.parameters().expand<Dual<1>>(q_s_, v);
    for (Mat3<Pack>& one : Q) one.setConstant(Pack(0.0));
    strain::for_each_direction({part_, values, points_, first, count}, Level::rates,
                               [&](int r, int i, const Jet<DualPack>& jet) {
                                 strain::set_column(Q[static_cast<std::size_t>(i)], r, jet.s2);
                               });
  }
  /// Computes d2F[v, w] of a block.
  void along(const VecMax<double>& v, const VecMax<double>& w, int first, int count, Matrices& Q) const {
    Matrices difference;
    along(VecMax<double>(v + w), first, count, Q);
    along(VecMax<double>(v - w), first, count, difference);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
      for (int c = 0; c < 9; ++c) Q[i].data()[c] = 0.25 * (Q[i].data()[c] - difference[i].data()[c]);
  }

 private:
  const Part& part_;
  const StrainPoints& points_;
  const VecMax<double>& q_s_;
};

/// The values and the derivatives of dual q_s and q_s_dot: q, dq, rate and d_rate.
struct SplitMotion {
  VecMax<double> q, dq, rate, d_rate;
  double length;             ///< largest |component| of dq, in multiples of the scales of the parameters
  VecMax<double> direction;  ///< dq / length; zero if dq is zero

  SplitMotion(const VecMax<Dual<1>>& q_s, const VecMax<Dual<1>>& q_s_dot, const VecMax<double>& unit) {
    const auto n = q_s.size();
    for (VecMax<double>* x : {&q, &dq, &rate, &d_rate}) x->resize(n);
    for (Eigen::Index k = 0; k < n; ++k) {
      q[k] = q_s[k].v;
      dq[k] = q_s[k].d[0];
      rate[k] = q_s_dot[k].v;
      d_rate[k] = q_s_dot[k].d[0];
    }
    length = dq.cwiseQuotient(unit).lpNorm<Eigen::Infinity>();
    direction = length > 0 ? VecMax<double>(dq / length) : dq;
  }
};

/// F, its rate and dF/dq_k at four points, with derivatives along the dual parts (dq, d_rate) of a motion.
struct DualStrain {
  Mat3<DualPack> F, F_dot;
  std::array<Mat3<DualPack>, kMaxGlobal> dF;

  /// second: second(k) is d2F[unit_k e_k, direction] of the pack, with the unit vector e_k of parameter k.
  template <class Second>
  void set(const Mat3<Pack>& F_now, const std::array<Mat3<Pack>, kMaxGlobal>& dF_now, const Second& second,
           const SplitMotion& motion, const VecMax<double>& unit) {
    Mat3<Pack> d_F_dot = strain::combine(dF_now, motion.d_rate);
    for (Eigen::Index k = 0; k < motion.q.size(); ++k) {
      const auto which = static_cast<std::size_t>(k);
      const Mat3<Pack> slope = scaled(Pack(motion.length / unit[k]), second(which));
      dF[which] = dual_pack(dF_now[which], slope);
      for (int c = 0; c < 9; ++c) d_F_dot.data()[c] += Pack(motion.rate[k]) * slope.data()[c];
    }
    F = dual_pack(F_now, strain::combine(dF_now, motion.dq));
    F_dot = dual_pack(strain::combine(dF_now, motion.rate), d_F_dot);
  }
};

/// Returns the first Piola-Kirchhoff stress of a law plus beta times its viscous stress. Adds weight times
/// the dissipated power per volume (per area of a sheet), which is at least 0, to `power`.
template <class Law>
Mat3<DualPack> damped_stress(const Law& law, const DualStrain& at, double beta, const Pack& weight,
                             DualPack& power) {
  Mat3<DualPack> P = law.stress(at.F);
  if (beta > 0) {
    const Mat3<DualPack> viscous = scaled(DualPack(beta), law.viscous(at.F, at.F_dot));
    power += contraction(viscous, at.F_dot) * weight;
    for (int c = 0; c < 9; ++c) P.data()[c] += viscous.data()[c];
  }
  return P;
}

}  // namespace detail

PLIANT_INLINE const std::vector<ContinuumLawInfo>& all_continuum_laws() {
  static const std::vector<ContinuumLawInfo> all{
      {"elastic",
       "Linear elasticity, for small changes of the parameters with little rotation of the material.", false},
      {"st_venant_kirchhoff", "St. Venant-Kirchhoff elasticity, for any rotation.", false},
      {"neo_hookean", "Rubber without a logarithm in its energy, for any rotation.", false},
      {"neo_hookean_log", "Classical compressible neo-Hookean rubber, for any rotation.", false},
      {"st_venant_kirchhoff_membrane", "A thin sheet that resists stretch, for any rotation.", true},
  };
  return all;
}

PLIANT_INLINE ContinuumLaw continuum_law(const ContinuumSettings& settings) {
  if (settings.law == "st_venant_kirchhoff_membrane") {
    const Sheet sheet{settings.E, settings.nu_P, settings.thickness};
    sheet.check();
    return SheetStrain(sheet);
  }
  if (settings.law == "elastic") return SmallStrain(Elasticity(settings.E, settings.nu_P));
  if (settings.law == "st_venant_kirchhoff")
    return Damped<StVenantKirchhoff>(Elasticity(settings.E, settings.nu_P));
  if (settings.law == "neo_hookean") return Damped<NeoHookean>(Elasticity(settings.E, settings.nu_P));
  if (settings.law == "neo_hookean_log") return Damped<NeoHookeanLog>(Elasticity(settings.E, settings.nu_P));
  std::string known;
  for (const ContinuumLawInfo& info : all_continuum_laws()) known += std::string(" ") + info.name;
  throw std::invalid_argument("no law of elasticity '" + settings.law + "'; there are:" + known);
}

PLIANT_INLINE ContinuumEnergy::ContinuumEnergy(const Part& part, const ContinuumSettings& settings,
                                               double volume)
    : settings_(settings), law_(continuum_law(settings)), points_(place_strain_points(part, law_, volume)) {
  const Parameters& all = part.parameters();
  unit_.resize(all.n_dynamic());
  for (int k = 0; k < all.n_dynamic(); ++k) {
    const ParameterSpec& spec = *all.moving(k).spec;
    unit_[k] = spec.relative                       ? all.moving(k).rest_value()
               : spec.quantity == Quantity::length ? part.size()
                                                   : 1.0;
  }
}

PLIANT_INLINE double ContinuumEnergy::energy(const Part& part, const VecMax<double>& q_s) const {
  const strain::DualValues values = detail::values_at(part, q_s);
  const int n = static_cast<int>(q_s.size());
  strain::Block block;
  Pack total(0.0);
  std::visit(
      [&](const auto& law) {
        detail::for_each_strain_block(points_, [&](int first, int count) {
          strain::evaluate({part, values, points_, first, count}, n, Level::position, block);
          for (int i = 0; i < count; ++i)
            total += points_.weight[static_cast<std::size_t>(first + i)] *
                     law.density(block.F[static_cast<std::size_t>(i)]);
        });
      },
      law_);
  return sum(total);
}

PLIANT_INLINE double ContinuumEnergy::add_force(const Part& part, const VecMax<double>& q_s,
                                                const VecMax<double>& q_s_dot, double beta,
                                                Eigen::Ref<VecX<double>> f, Counters& counters) const {
  const strain::DualValues values = detail::values_at(part, q_s);
  const int n = static_cast<int>(q_s.size());
  const bool damped = beta > 0 && !q_s_dot.isZero(0);
  strain::Block block;
  std::array<Pack, kMaxGlobal> force;
  force.fill(Pack(0.0));
  Pack power(0.0);
  std::visit(
      [&](const auto& law) {
        detail::for_each_strain_block(points_, [&](int first, int count) {
          strain::evaluate({part, values, points_, first, count}, n, Level::jacobian, block);
          for (int i = 0; i < count; ++i) {
            const auto at = static_cast<std::size_t>(i);
            const Pack& weight = points_.weight[static_cast<std::size_t>(first + i)];
            detail::throw_if_inverted(law, block.F[at]);
            Mat3<Pack> P = law.stress(block.F[at]);
            if (damped) {
              const Mat3<Pack> F_dot = strain::combine(block.dF[at], q_s_dot);
              const Mat3<Pack> viscous = scaled(Pack(beta), law.viscous(block.F[at], F_dot));
              power += weight * contraction(viscous, F_dot);
              for (int c = 0; c < 9; ++c) P.data()[c] += viscous.data()[c];
            }
            for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k)
              force[k] += weight * contraction(P, block.dF[at][k]);
          }
        });
      },
      law_);
  for (int k = 0; k < n; ++k) f[k] -= sum(force[static_cast<std::size_t>(k)]);
  counters.strain_points += points_.n_points;
  return -sum(power);
}

PLIANT_INLINE Dual<1> ContinuumEnergy::add_force(const Part& part, const VecMax<Dual<1>>& q_s,
                                                 const VecMax<Dual<1>>& q_s_dot, double beta,
                                                 Eigen::Ref<VecX<Dual<1>>> f, Counters& counters) const {
  using detail::DualPack;
  const int n = static_cast<int>(q_s.size());
  const detail::SplitMotion motion(q_s, q_s_dot, unit_);
  const strain::DualValues values = detail::values_at(part, motion.q);
  const detail::SecondStrainDerivatives second(part, points_, motion.q);
  strain::Block block;
  std::array<detail::SecondStrainDerivatives::Matrices, kMaxGlobal> d2F;
  detail::DualStrain strain_at;
  std::array<DualPack, kMaxGlobal> force;
  force.fill(DualPack(0.0));
  DualPack power(0.0);
  std::visit(
      [&](const auto& law) {
        detail::for_each_strain_block(points_, [&](int first, int count) {
          strain::evaluate({part, values, points_, first, count}, n, Level::jacobian, block);
          for (int k = 0; k < n; ++k)
            second.along(VecMax<double>(VecMax<double>::Unit(n, k) * unit_[k]), motion.direction, first,
                         count, d2F[static_cast<std::size_t>(k)]);
          for (int i = 0; i < count; ++i) {
            const auto at = static_cast<std::size_t>(i);
            const Pack& weight = points_.weight[static_cast<std::size_t>(first + i)];
            detail::throw_if_inverted(law, block.F[at]);
            strain_at.set(
                block.F[at], block.dF[at], [&](std::size_t k) -> const Mat3<Pack>& { return d2F[k][at]; },
                motion, unit_);
            const Mat3<DualPack> P = detail::damped_stress(law, strain_at, beta, weight, power);
            for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k)
              force[k] += contraction(P, strain_at.dF[k]) * weight;
          }
        });
      },
      law_);
  for (int k = 0; k < n; ++k) f[k] -= detail::sum_of_lanes(force[static_cast<std::size_t>(k)]);
  counters.strain_points += points_.n_points;
  return -detail::sum_of_lanes(power);
}

PLIANT_INLINE MatX<double> ContinuumEnergy::stiffness(const Part& part, const VecMax<double>& q_s) const {
  const auto n = q_s.size();
  MatX<double> K(n, n);
  Counters unused;
  for (Eigen::Index j = 0; j < n; ++j) {
    VecMax<Dual<1>> q = q_s.cast<Dual<1>>(), rate(n);
    rate.setConstant(Dual<1>(0.0));
    q[j].d[0] = 1;
    VecX<Dual<1>> f = VecX<Dual<1>>::Constant(n, Dual<1>(0.0));
    add_force(part, q, rate, 0, f, unused);
    for (Eigen::Index i = 0; i < n; ++i) K(i, j) = -f[i].d[0];
  }
  return 0.5 * (K + K.transpose());
}

PLIANT_INLINE MatX<double> ContinuumEnergy::strain_stiffness(const Part& part,
                                                             const VecMax<double>& q_s) const {
  const int n = static_cast<int>(q_s.size());
  const strain::DualValues values = detail::values_at(part, q_s);
  MatX<double> K = MatX<double>::Zero(n, n);
  strain::Block block;
  std::visit(
      [&](const auto& law) {
        detail::for_each_strain_block(points_, [&](int first, int count) {
          strain::evaluate({part, values, points_, first, count}, n, Level::jacobian, block);
          for (int i = 0; i < count; ++i) {
            const auto at = static_cast<std::size_t>(i);
            const Pack& weight = points_.weight[static_cast<std::size_t>(first + i)];
            for (int j = 0; j < n; ++j) {
              const Mat3<Pack> P = law.viscous(block.F[at], block.dF[at][static_cast<std::size_t>(j)]);
              for (int k = 0; k <= j; ++k)
                K(k, j) += sum(weight * contraction(P, block.dF[at][static_cast<std::size_t>(k)]));
            }
          }
        });
      },
      law_);
  return K.selfadjointView<Eigen::Upper>();
}

}  // namespace pliant
