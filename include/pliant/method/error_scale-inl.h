// Bodies of error_scale.h.
#pragma once

#include <pliant/math/header_only.h>
#include <pliant/method/error_scale.h>

#include <algorithm>
#include <cmath>

namespace pliant {

PLIANT_INLINE ErrorScale::ErrorScale(const Model& model, double tolerance)
    : model_(&model), tolerance_(tolerance) {
  parameter_.setOnes(model.n_v());
  for (const PartModel& m : model.parts()) {
    if (m.q0 < 0) continue;
    const double size = m.part->size();
    for (int k = 0; k < m.n_s; ++k)
      if (m.part->parameters().moving(k).spec->quantity == Quantity::length)
        parameter_[m.v0 + 6 + k] = 1 / size;
    if (m.n_d() == 0) continue;
    // Amplitudes of modes are scaled by the square root of the mass.
    const double each = m.local->oscillators() != nullptr ? 1 / std::sqrt(m.part->total_mass())
                                                          : std::sqrt(3.0 / static_cast<double>(m.n_d()));
    parameter_.segment(m.v0 + 6 + m.n_s, m.n_d()).setConstant(each / size);
  }
}

/// Calls take(error, part, name) for each block. Errors are not divided by the tolerance.
template <class Take>
void ErrorScale::of_coordinates(const VecX<double>& of_q, Take&& take) const {
  for (const PartModel& m : model_->parts()) {
    if (m.q0 < 0) continue;
    take(of_q.segment<3>(m.q0).norm() / m.part->size(), m, "the place");
    take(2 * of_q.segment<4>(m.q0 + 3).norm(), m, "the rotation");
    const auto scale = parameter_.segment(m.v0 + 6, m.n_s + m.n_d());
    const auto rest = of_q.segment(m.q0 + 7, m.n_s + m.n_d());
    if (m.n_s > 0)
      take(rest.head(m.n_s).cwiseProduct(scale.head(m.n_s)).lpNorm<Eigen::Infinity>(), m, "the parameters");
    if (m.n_d() > 0) take(rest.tail(m.n_d()).norm() * scale[m.n_s], m, "the local displacement");
  }
}

template <class Take>
void ErrorScale::of_velocities(const VecX<double>& of_v, const VecX<double>& v, Take&& take) const {
  for (const PartModel& m : model_->parts()) {
    if (m.q0 < 0) continue;
    const double size = m.part->size();
    const auto scale = parameter_.segment(m.v0 + 6, m.n_s + m.n_d());
    const auto rest = of_v.segment(m.v0 + 6, m.n_s + m.n_d());
    double fastest = std::max(v.segment<3>(m.v0).norm() / size, v.segment<3>(m.v0 + 3).norm());
    if (m.n_s > 0)
      fastest = std::max(
          fastest, v.segment(m.v0 + 6, m.n_s).cwiseProduct(scale.head(m.n_s)).lpNorm<Eigen::Infinity>());
    if (m.n_d() > 0) fastest = std::max(fastest, v.segment(m.v0 + 6 + m.n_s, m.n_d()).norm() * scale[m.n_s]);
    const double time = 1 / (1 + fastest);
    take(time * of_v.segment<3>(m.v0).norm() / size, m, "the velocity");
    take(time * of_v.segment<3>(m.v0 + 3).norm(), m, "the angular velocity");
    if (m.n_s > 0)
      take(time * rest.head(m.n_s).cwiseProduct(scale.head(m.n_s)).lpNorm<Eigen::Infinity>(), m,
           "the rates of the parameters");
    if (m.n_d() > 0) take(time * rest.tail(m.n_d()).norm() * scale[m.n_s], m, "the local velocity");
  }
}

namespace error_scale {
/// Returns the larger of two errors, or NaN if the first is NaN.
inline double larger(double error, double most) {
  return error <= most ? most : error;
}
}  // namespace error_scale

PLIANT_INLINE double ErrorScale::norm(const VecX<double>& of_q, const VecX<double>& of_v,
                                      const VecX<double>& v) const {
  double most = 0;
  auto take = [&](double error, const PartModel&, const char*) { most = error_scale::larger(error, most); };
  of_coordinates(of_q, take);
  of_velocities(of_v, v, take);
  return most / tolerance_;
}

PLIANT_INLINE double ErrorScale::norm(const VecX<double>& of_q) const {
  double most = 0;
  of_coordinates(
      of_q, [&](double error, const PartModel&, const char*) { most = error_scale::larger(error, most); });
  return most / tolerance_;
}

PLIANT_INLINE std::string ErrorScale::worst(const VecX<double>& of_q, const VecX<double>& of_v,
                                            const VecX<double>& v) const {
  double most = -1;
  std::string words;
  auto take = [&](double error, const PartModel& m, const char* what) {
    if (!(error_scale::larger(error, most) != most)) return;
    most = error;
    words = std::string(what) + " of part '" + m.part->name() + "'";
  };
  of_coordinates(of_q, take);
  of_velocities(of_v, v, take);
  return words;
}

}  // namespace pliant
