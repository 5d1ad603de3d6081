// Stage 3, loads: the forces at the ports of a distributed force.
#pragma once

#include <array>

#include <pliant/body/stages/signals.h>

namespace pliant::detail {

/// Values at a point, in the order of quantities_at_points().
template <class S>
using QuantitiesAtPoint = std::array<S, 13>;

template <class S>
QuantitiesAtPoint<S> quantities_at(const Vec3<S>& x, const Vec3<S>& v, const Vec3<double>& X,
                                   const Vec3<S>& n) {
  return {x[0], x[1], x[2], v[0], v[1], v[2], S(X[0]), S(X[1]), S(X[2]), n[0], n[1], n[2], S(v.dot(n))};
}

/// A function of time, state and place, at many points. Quantities of the state are evaluated once.
template <class S>
class FunctionAtPoints {
 public:
  FunctionAtPoints(const Evaluation<S>& e, const FunctionModel& f) : t_(e.t), f_(f) {
    for (std::size_t k = 0; k < f.signals.size(); ++k) {
      if (f.signals[k].signal->kind == Signal::Kind::at_point)
        of_point_[n_of_point_++] = k;
      else
        values_[k] = signal_value(e, f.signals[k]);
    }
    if (n_of_point_ == 0) value_ = value_of(e, f);
  }

  S value(const QuantitiesAtPoint<S>& at) {
    if (n_of_point_ == 0) return value_;
    for (std::size_t i = 0; i < n_of_point_; ++i)
      values_[of_point_[i]] = at[static_cast<std::size_t>(f_.signals[of_point_[i]].signal->index)];
    return f_.function->formula().template value<S>(S(t_), values_.data());
  }

 private:
  double t_;
  const FunctionModel& f_;
  std::array<S, kMaxSignals> values_;
  std::array<std::size_t, kMaxSignals> of_point_;
  std::size_t n_of_point_ = 0;
  S value_{0.0};
};

/// The density and the pressure of a distributed force at points.
template <class S>
class DensityAtPoints {
 public:
  DensityAtPoints(const Evaluation<S>& e, const DistributedModel& m)
      : density_{{{e, m.density[0]}, {e, m.density[1]}, {e, m.density[2]}}}, pressure_(e, m.pressure) {}

  Vec3<S> density(const QuantitiesAtPoint<S>& at) {
    return {density_[0].value(at), density_[1].value(at), density_[2].value(at)};
  }
  S pressure(const QuantitiesAtPoint<S>& at) { return pressure_.value(at); }

 private:
  std::array<FunctionAtPoints<S>, 3> density_;
  FunctionAtPoints<S> pressure_;
};

/// Calls act(port, force) with the forces (N, world) at the ports of a distributed force. A port may get
/// several forces. In a body, the force at a port is the force on the mass of the port. On a surface, the
/// force on a triangle is the density at the centre of the triangle times its area, and each corner gets a
/// third of this force. The error is of second order in the size of the triangles.
template <class S, class Act>
void for_each_force(const Evaluation<S>& e, const DistributedModel& m, Act&& act) {
  const PartWorkspace<S>& w = e.part_work(m.part);
  DensityAtPoints<S> at_points(e, m);
  auto x = [&](int k) -> const Vec3<S>& { return w.port_x[static_cast<std::size_t>(m.first_port + k)]; };
  auto x_dot = [&](int k) -> const Vec3<S>& {
    return w.port_x_dot[static_cast<std::size_t>(m.first_port + k)];
  };
  for (int k = 0; k < static_cast<int>(m.mass.size()); ++k) {
    const auto at = quantities_at<S>(x(k), x_dot(k), m.X.col(k), Vec3<S>::Constant(S(0.0)));
    act(m.first_port + k, Vec3<S>(at_points.density(at) * S(m.mass[k])));
  }
  for (Eigen::Index i = 0; i < m.triangles.cols(); ++i) {
    const int a = m.triangles(0, i), b = m.triangles(1, i), c = m.triangles(2, i);
    const Vec3<S> twice_area = Vec3<S>(x(b) - x(a)).cross(Vec3<S>(x(c) - x(a)));
    const S size2 = twice_area.dot(twice_area);
    if (plain(size2) == 0) continue;
    const S size = math::sqrt(size2), third(1.0 / 3);
    const auto at = quantities_at<S>((x(a) + x(b) + x(c)) * third, (x_dot(a) + x_dot(b) + x_dot(c)) * third,
                                     (m.X.col(a) + m.X.col(b) + m.X.col(c)) / 3, twice_area / size);
    Vec3<S> force = twice_area * S(-at_points.pressure(at));
    if (m.has_density) force += at_points.density(at) * size;
    force = force * S(1.0 / 6);
    for (const int corner : {a, b, c}) act(m.first_port + corner, force);
  }
}

}  // namespace pliant::detail
