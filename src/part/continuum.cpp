#include <pliant/part/continuum.h>

#include <cmath>
#include <stdexcept>

#include <pliant/local/solid/corotated.h>
#include <pliant/part/part.h>

#include "part/quadrature/strain_rule.h"
#include "strain.h"

namespace pliant {

namespace {

using DualPack = Dual<1, Pack>;

DualPack dual(const Pack& value, const Pack& slope) {
  DualPack x(value);
  x.d[0] = slope;
  return x;
}
Mat3<DualPack> dual(const Mat3<Pack>& F, const Mat3<Pack>& dF) {
  Mat3<DualPack> D;
  for (int i = 0; i < 9; ++i) D.data()[i] = dual(F.data()[i], dF.data()[i]);
  return D;
}

/// Throws where a point of the rest body is turned inside out; a sheet cannot be.
template <class Law>
void refuse_inversion(const Law&, const Mat3<Pack>& F) {
  if constexpr (!std::is_same_v<Law, SheetStrain>)
    if (!(least_of(determinant(F, cofactors(F))) > 0))
      throw InvertedElement(
          "its global deformation turns some of its elastic material inside out; a smaller step, a stiffer "
          "material or limits (min, max) of its parameters keep it from that");
}

/// Second derivatives of F along pairs of directions from those along single ones, Q(v) = d2F[v, v]:
/// 4 d2F[v, w] = Q(v + w) - Q(v - w).
class SecondDerivatives {
 public:
  SecondDerivatives(const Part& part, const StrainPoints& points, const VecMax<double>& q_s)
      : part_(part), points_(points), q_s_(q_s) {}
  using Matrices = std::array<Mat3<Pack>, strain::kBlock>;

  void along(const VecMax<double>& v, int first, int count, Matrices& Q) const {
    const auto values = part_.parameters().expand<Dual<1>>(q_s_, v);
    for (Mat3<Pack>& one : Q) one.setConstant(Pack(0.0));
    strain::for_each_direction(part_, values, points_, first, count, Level::rates,
                               [&](int r, int i, const Jet<DualPack>& jet) {
                                 strain::put_column(Q[static_cast<std::size_t>(i)], r, jet.s2);
                               });
  }
  void along(const VecMax<double>& v, const VecMax<double>& w, int first, int count, Matrices& Q) const {
    Matrices less;
    along(VecMax<double>(v + w), first, count, Q);
    along(VecMax<double>(v - w), first, count, less);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
      for (int c = 0; c < 9; ++c) Q[i].data()[c] = 0.25 * (Q[i].data()[c] - less[i].data()[c]);
  }

 private:
  const Part& part_;
  const StrainPoints& points_;
  const VecMax<double>& q_s_;
};

strain::DualValues still(const Part& part, const VecMax<double>& q_s) {
  return part.parameters().expand<Dual<1>>(q_s, VecMax<double>(VecMax<double>::Zero(q_s.size())));
}

/// act(block, first, count) for all points.
template <class F>
void for_each_block(const StrainPoints& points, F&& act) {
  const int packs = static_cast<int>(points.weight.size());
  for (int first = 0; first < packs; first += strain::kBlock)
    act(first, std::min(strain::kBlock, packs - first));
}

}  // namespace

const std::vector<ContinuumLawInfo>& all_continuum_laws() {
  static const std::vector<ContinuumLawInfo> all{
      {"elastic", "Linear elasticity: for small changes of the parameters that turn the material little.",
       false},
      {"st_venant_kirchhoff", "St. Venant-Kirchhoff elasticity, by any rotation.", false},
      {"neo_hookean", "Rubber, by any rotation.", false},
      {"st_venant_kirchhoff_membrane", "A thin sheet that resists stretch, by any rotation.", true},
  };
  return all;
}

ContinuumLaw continuum_law(const ContinuumSettings& settings) {
  if (settings.law == "st_venant_kirchhoff_membrane") {
    const Sheet sheet{settings.E, settings.nu_P, settings.thickness};
    sheet.check();
    return SheetStrain(sheet);
  }
  if (settings.law == "elastic") return SmallStrain(Elasticity(settings.E, settings.nu_P));
  if (settings.law == "st_venant_kirchhoff")
    return Damped<StVenantKirchhoff>(Elasticity(settings.E, settings.nu_P));
  if (settings.law == "neo_hookean") return Damped<NeoHookean>(Elasticity(settings.E, settings.nu_P));
  std::string known;
  for (const ContinuumLawInfo& info : all_continuum_laws()) known += std::string(" ") + info.name;
  throw std::invalid_argument("no law of elasticity '" + settings.law + "'; there are:" + known);
}

ContinuumEnergy::ContinuumEnergy(const Part& part, const ContinuumSettings& settings, double volume)
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

double ContinuumEnergy::energy(const Part& part, const VecMax<double>& q_s) const {
  const strain::DualValues values = still(part, q_s);
  const int n = static_cast<int>(q_s.size());
  strain::Block block;
  Pack total(0.0);
  std::visit(
      [&](const auto& law) {
        for_each_block(points_, [&](int first, int count) {
          strain::evaluate(part, values, points_, first, count, n, Level::position, block);
          for (int i = 0; i < count; ++i)
            total += points_.weight[static_cast<std::size_t>(first + i)] *
                     law.density(block.F[static_cast<std::size_t>(i)]);
        });
      },
      law_);
  return sum(total);
}

double ContinuumEnergy::add_force(const Part& part, const VecMax<double>& q_s, const VecMax<double>& q_s_dot,
                                  double beta, Eigen::Ref<VecX<double>> f, Counters& counters) const {
  const strain::DualValues values = still(part, q_s);
  const int n = static_cast<int>(q_s.size());
  const bool damped = beta > 0 && !q_s_dot.isZero(0);
  strain::Block block;
  std::array<Pack, kMaxGlobal> push;
  push.fill(Pack(0.0));
  Pack power(0.0);
  std::visit(
      [&](const auto& law) {
        for_each_block(points_, [&](int first, int count) {
          strain::evaluate(part, values, points_, first, count, n, Level::jacobian, block);
          for (int i = 0; i < count; ++i) {
            const auto at = static_cast<std::size_t>(i);
            const Pack& weight = points_.weight[static_cast<std::size_t>(first + i)];
            refuse_inversion(law, block.F[at]);
            Mat3<Pack> P = law.stress(block.F[at]);
            if (damped) {
              const Mat3<Pack> F_dot = strain::combine(block.dF[at], q_s_dot);
              const Mat3<Pack> viscous = scaled(Pack(beta), law.viscous(block.F[at], F_dot));
              power += weight * contraction(viscous, F_dot);
              for (int c = 0; c < 9; ++c) P.data()[c] += viscous.data()[c];
            }
            for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k)
              push[k] += weight * contraction(P, block.dF[at][k]);
          }
        });
      },
      law_);
  for (int k = 0; k < n; ++k) f[k] -= sum(push[static_cast<std::size_t>(k)]);
  counters.strain_points += points_.n_points;
  return -sum(power);
}

Dual<1> ContinuumEnergy::add_force(const Part& part, const VecMax<Dual<1>>& q_s,
                                   const VecMax<Dual<1>>& q_s_dot, double beta, Eigen::Ref<VecX<Dual<1>>> f,
                                   Counters& counters) const {
  const int n = static_cast<int>(q_s.size());
  VecMax<double> q(n), dq(n), rate(n), rate_d(n);
  for (int k = 0; k < n; ++k) {
    q[k] = q_s[k].v;
    dq[k] = q_s[k].d[0];
    rate[k] = q_s_dot[k].v;
    rate_d[k] = q_s_dot[k].d[0];
  }
  const double size = dq.cwiseQuotient(unit_).lpNorm<Eigen::Infinity>();
  const VecMax<double> way = size > 0 ? VecMax<double>(dq / size) : dq;
  const strain::DualValues values = still(part, q);
  const SecondDerivatives second(part, points_, q);
  strain::Block block;
  std::array<SecondDerivatives::Matrices, kMaxGlobal> of_dF;  // d(dF/dq_k) along way
  std::array<DualPack, kMaxGlobal> push;
  push.fill(DualPack(0.0));
  DualPack power(0.0);
  std::visit(
      [&](const auto& law) {
        for_each_block(points_, [&](int first, int count) {
          strain::evaluate(part, values, points_, first, count, n, Level::jacobian, block);
          for (int k = 0; k < n; ++k)
            second.along(VecMax<double>(VecMax<double>::Unit(n, k) * unit_[k]), way, first, count,
                         of_dF[static_cast<std::size_t>(k)]);
          for (int i = 0; i < count; ++i) {
            const auto at = static_cast<std::size_t>(i);
            const Pack& weight = points_.weight[static_cast<std::size_t>(first + i)];
            refuse_inversion(law, block.F[at]);
            std::array<Mat3<DualPack>, kMaxGlobal> dF;
            Mat3<Pack> turn = strain::combine(block.dF[at], rate_d);
            for (int k = 0; k < n; ++k) {
              const auto which = static_cast<std::size_t>(k);
              const Mat3<Pack> slope = scaled(Pack(size / unit_[k]), of_dF[which][at]);
              dF[which] = dual(block.dF[at][which], slope);
              for (int c = 0; c < 9; ++c) turn.data()[c] += Pack(rate[k]) * slope.data()[c];
            }
            const Mat3<DualPack> F = dual(block.F[at], strain::combine(block.dF[at], dq)),
                                 F_dot = dual(strain::combine(block.dF[at], rate), turn);
            Mat3<DualPack> P = law.stress(F);
            if (beta > 0) {
              const Mat3<DualPack> viscous = scaled(DualPack(beta), law.viscous(F, F_dot));
              power += contraction(viscous, F_dot) * weight;
              for (int c = 0; c < 9; ++c) P.data()[c] += viscous.data()[c];
            }
            for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k)
              push[k] += contraction(P, dF[k]) * weight;
          }
        });
      },
      law_);
  auto total = [](const DualPack& x) {
    Dual<1> r(sum(x.v));
    r.d[0] = sum(x.d[0]);
    return r;
  };
  for (int k = 0; k < n; ++k) f[k] -= total(push[static_cast<std::size_t>(k)]);
  counters.strain_points += points_.n_points;
  return -total(power);
}

MatX<double> ContinuumEnergy::stiffness(const Part& part, const VecMax<double>& q_s) const {
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

MatX<double> ContinuumEnergy::strain_stiffness(const Part& part, const VecMax<double>& q_s) const {
  const int n = static_cast<int>(q_s.size());
  const strain::DualValues values = still(part, q_s);
  MatX<double> K = MatX<double>::Zero(n, n);
  strain::Block block;
  std::visit(
      [&](const auto& law) {
        for_each_block(points_, [&](int first, int count) {
          strain::evaluate(part, values, points_, first, count, n, Level::jacobian, block);
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
