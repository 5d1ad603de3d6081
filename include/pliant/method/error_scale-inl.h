// Function bodies of error_scale.h: the scale of each block of coordinates and the largest scaled error.
#pragma once

#include <pliant/method/error_scale.h>

#include <algorithm>
#include <cmath>

#include <pliant/body/speed_scale.h>
#include <pliant/math/header_only.h>
#include <pliant/math/max_or_nan.h>

namespace pliant {

PLIANT_INLINE ErrorScale::ErrorScale(const Model& model, double tolerance)
    : model_(&model), tolerance_(tolerance) {
  parameter_.setOnes(model.n_v());
  for (const PartModel& m : model.parts()) {
    if (m.q0 < 0) continue;
    const double size = m.size;
    for (int k = 0; k < m.n_s; ++k)
      if (m.part->parameters().moving(k).spec->quantity == Quantity::length)
        parameter_[m.v0 + 6 + k] = 1 / size;
    if (m.n_d() == 0) continue;
    const double mean = m.local->oscillators() != nullptr ? 1 : std::sqrt(3.0 / static_cast<double>(m.n_d()));
    parameter_.segment(m.v0 + 6 + m.n_s, m.n_d()) = mean / size * local_levers(m);
  }
}

/// Calls visit(error, part, name of the block) for each block of coordinates. Errors are not divided by the
/// tolerance.
template <class Visit>
void ErrorScale::visit_coordinates(const VecX<double>& q_error, Visit&& visit) const {
  for (const PartModel& m : model_->parts()) {
    if (m.q0 < 0) continue;
    visit(q_error.segment<3>(m.q0).norm() / m.size, m, "the position");
    visit(2 * q_error.segment<4>(m.q0 + 3).norm(), m, "the rotation");
    const auto scale = parameter_.segment(m.v0 + 6, m.n_s + m.n_d());
    const auto other = q_error.segment(m.q0 + 7, m.n_s + m.n_d());
    if (m.n_s > 0)
      visit(other.head(m.n_s).cwiseProduct(scale.head(m.n_s)).lpNorm<Eigen::Infinity>(), m, "the parameters");
    if (m.n_d() > 0)
      visit(other.tail(m.n_d()).cwiseProduct(scale.tail(m.n_d())).norm(), m, "the local displacement");
  }
}

/// Calls visit(error, part, name of the block) for each block of velocities. Errors are not divided by the
/// tolerance.
template <class Visit>
void ErrorScale::visit_velocities(const VecX<double>& v_error, const VecX<double>& v, Visit&& visit) const {
  for (const PartModel& m : model_->parts()) {
    if (m.q0 < 0) continue;
    const double size = m.size;
    const auto scale = parameter_.segment(m.v0 + 6, m.n_s + m.n_d());
    const auto other = v_error.segment(m.v0 + 6, m.n_s + m.n_d());
    double fastest = std::max(v.segment<3>(m.v0).norm() / size, v.segment<3>(m.v0 + 3).norm());
    if (m.n_s > 0)
      fastest = std::max(
          fastest, v.segment(m.v0 + 6, m.n_s).cwiseProduct(scale.head(m.n_s)).lpNorm<Eigen::Infinity>());
    if (m.n_d() > 0)
      fastest =
          std::max(fastest, v.segment(m.v0 + 6 + m.n_s, m.n_d()).cwiseProduct(scale.tail(m.n_d())).norm());
    const double time = 1 / (slow_rate(*model_) + fastest);
    visit(time * v_error.segment<3>(m.v0).norm() / size, m, "the velocity");
    visit(time * v_error.segment<3>(m.v0 + 3).norm(), m, "the angular velocity");
    if (m.n_s > 0)
      visit(time * other.head(m.n_s).cwiseProduct(scale.head(m.n_s)).lpNorm<Eigen::Infinity>(), m,
            "the rates of the parameters");
    if (m.n_d() > 0)
      visit(time * other.tail(m.n_d()).cwiseProduct(scale.tail(m.n_d())).norm(), m, "the local velocity");
  }
}

PLIANT_INLINE double ErrorScale::norm(const VecX<double>& q_error, const VecX<double>& v_error,
                                      const VecX<double>& v) const {
  double largest = 0;
  auto visit = [&](double error, const PartModel&, const char*) { largest = max_or_nan(error, largest); };
  visit_coordinates(q_error, visit);
  visit_velocities(v_error, v, visit);
  return largest / tolerance_;
}

PLIANT_INLINE double ErrorScale::norm(const VecX<double>& q_error) const {
  double largest = 0;
  visit_coordinates(
      q_error, [&](double error, const PartModel&, const char*) { largest = max_or_nan(error, largest); });
  return largest / tolerance_;
}

PLIANT_INLINE std::string ErrorScale::worst(const VecX<double>& q_error, const VecX<double>& v_error,
                                            const VecX<double>& v) const {
  double largest = -1;
  std::string block;
  auto visit = [&](double error, const PartModel& m, const char* name) {
    if (error <= largest || std::isnan(largest)) return;
    largest = error;
    block = std::string(name) + " of part '" + m.part->name() + "'";
  };
  visit_coordinates(q_error, visit);
  visit_velocities(v_error, v, visit);
  return block;
}

}  // namespace pliant
