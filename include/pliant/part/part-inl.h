// Function bodies of Part: the steps that compute the constants of a part.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <pliant/math/header_only.h>
#include <pliant/part/mesh/folds.h>
#include <pliant/part/part.h>
#include <pliant/part/sum_inertia.h>

namespace pliant {

PLIANT_INLINE void Part::prepare() {
  ConstantsCache of_this_part;
  prepare(of_this_part);
}

PLIANT_INLINE void Part::prepare(ConstantsCache& known) {
  if (prepared()) return;
  update_parameters();
  check();
  std::optional<ConstantsKey> key = constants_key();
  std::shared_ptr<const PartConstants> shared = key ? known.find(*key) : nullptr;
  if (shared) {
    constants_ = std::move(shared);
  } else {
    compute_constants();
    if (key) known.store(*std::move(key), constants_);
  }
  set_unchanged();
}

PLIANT_INLINE void Part::compute_constants() {
  const auto computed = std::make_shared<PartConstants>();
  constants_ = computed;  // the steps below evaluate this part
  computed->K_s = dynamic_stiffness();
  compute_size(*computed);
  if (given_inertia() != nullptr) return use_given_inertia(*computed);
  const double volume = compute_inertia(*computed);
  compute_elasticity(volume, *computed);
}

PLIANT_INLINE void Part::compute_size(PartConstants& out) const {
  static const std::vector<Material<double>> surface = [] {
    std::vector<Material<double>> sample;
    for (int i = 0; i < 16; ++i)
      for (int j = -4; j <= 4; ++j) sample.push_back(material_at(j * kPi / 8, i * kPi / 8));
    return sample;
  }();
  out.size = s(surface, parameters().rest()).rowwise().lpNorm<Eigen::Infinity>().maxCoeff();
}

PLIANT_INLINE void Part::use_given_inertia(PartConstants& out) const {
  throw_if_folded(*this, parameters().rest(), "rest");
  out.rest_inertia = *given_inertia();
}

PLIANT_INLINE double Part::compute_inertia(PartConstants& out) const {
  MassPoints& points = out.mass_points;
  points = place_mass_points(*this);
  const int n = parameters().n_dynamic();
  VecMax<double> q_s(n);
  for (int k = 0; k < n; ++k) q_s[k] = parameters().moving(k).rest_value();
  auto inertia_at_rest = [&] {
    Inertia<double> inertia;
    Counters unused;
    sum_inertia(*this, points, q_s, VecMax<double>::Zero(n), Vec3<double>::Zero(), inertia, unused);
    return inertia;
  };
  out.rest_inertia = inertia_at_rest();
  const bool by_search = mass_distribution() != nullptr && continuum_settings() != nullptr;
  const double volume = by_search ? volume_at_rest(*this) : total_mass() / density();
  if (given_mass()) {
    const double factor = *given_mass() / total_mass();
    for (Pack& m : points.mass) m *= Pack(factor);
    out.rest_inertia = inertia_at_rest();
  }
  if (linear()) out.linear_inertia = make_linear_inertia(*this, points);
  return volume;
}

PLIANT_INLINE void Part::compute_elasticity(double volume, PartConstants& out) const {
  if (local_settings() != nullptr) out.local = make_local_deformation(*this, *local_settings());
  if (continuum_settings() != nullptr && parameters().n_dynamic() > 0)
    out.continuum = std::make_unique<ContinuumEnergy>(*this, *continuum_settings(), volume);
}

PLIANT_INLINE double Part::inertia_floor(int k) const {
  constexpr double relative_rounding = 1e-24;
  const bool length = parameters().moving(k).spec->quantity == Quantity::length;
  return relative_rounding * total_mass() * (length ? 1.0 : size() * size());
}

PLIANT_INLINE MatX<double> Part::elastic_stiffness(const VecMax<double>& q_s) const {
  return continuum() != nullptr ? MatX<double>(K_s() + continuum()->stiffness(*this, q_s)) : K_s();
}

PLIANT_INLINE MatX<double> Part::strain_stiffness(const VecMax<double>& q_s) const {
  return continuum() != nullptr ? MatX<double>(K_s() + continuum()->strain_stiffness(*this, q_s)) : K_s();
}

}  // namespace pliant
