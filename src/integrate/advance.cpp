#include <pliant/integrate/advance.h>

#include <array>
#include <cmath>
#include <vector>

#include <pliant/math/sinc.h>
#include <pliant/solve/complementarity.h>

namespace pliant {

namespace {
void advance_part(const PartModel& m, VecX<double>& q, const VecX<double>& v, double h) {
  q.segment<3>(m.q0) += h * v.segment<3>(m.v0);
  const Vec3<double> half = 0.5 * h * v.segment<3>(m.v0 + 3);
  const double angle = half.norm();
  const math::SinCos<double> of_angle = math::sin_cos(angle);
  const Vec3<double> axis = sinc(angle, of_angle) * half;
  const Eigen::Quaterniond turn(of_angle.cos, axis[0], axis[1], axis[2]);
  auto theta = q.segment<4>(m.q0 + 3);
  const Eigen::Quaterniond now =
      (Eigen::Quaterniond(theta[0], theta[1], theta[2], theta[3]) * turn).normalized();
  theta << now.w(), now.x(), now.y(), now.z();
  q.segment(m.q0 + 7, m.n_s) += h * v.segment(m.v0 + 6, m.n_s);
}
}  // namespace

void advance_coordinates(const Model& model, VecX<double>& q, const VecX<double>& v, double h) {
  for (const PartModel& m : model.parts())
    if (m.q0 >= 0) advance_part(m, q, v, h);
}

void normalise_rotations(const Model& model, VecX<double>& q) {
  for (const PartModel& m : model.parts())
    if (m.q0 >= 0) q.segment<4>(m.q0 + 3).normalize();
}

void hold_inertialess(const Model& model, const Workspace<double>& work, VecX<double>& v) {
  for (std::size_t i = 0; i < model.parts().size(); ++i) {
    const PartModel& m = model.parts()[i];
    if (m.q0 < 0 || !work.parts[i].factor.any_held()) continue;
    for (int k = 0; k < 6 + m.n_s; ++k)
      if (work.parts[i].factor.held(k)) v[m.v0 + k] = 0;
  }
}

namespace {

Range limits_of(const PartModel& m, int k) {
  return m.part->parameters().moving(k).limits;
}

/// A one-sided row of a part: sign * x_k >= bound for parameter k, at its lower limit (sign 1) or its upper
/// one (-1).
struct Row {
  int k;
  double sign, bound;
};

/// The least change of x = (c, omega, q_s parts of a velocity or of a small motion) in the mass metric that
/// meets its rows, which push only: sum of M^-1 e_k sign lambda, lambda >= 0.
class LimitRows {
 public:
  LimitRows(const PartModel& m, const PartWorkspace<double>& w) : m_(m), w_(w) {}

  bool empty() const { return n_ == 0; }
  void add(const Row& row) {
    VecMax<double> response = VecMax<double>::Zero(6 + m_.n_s);
    response[6 + row.k] = row.sign;
    Dynamics::apply_impulse(w_, response);
    rows_[n_] = row;
    responses_[n_++] = response;
  }
  /// Adds the rows of bound(k, sign) that x does not meet; false when there is none.
  template <class Bound>
  bool add_unmet(const VecMax<double>& x, Bound&& bound) {
    const std::size_t before = n_;
    for (int k = 0; k < m_.n_s; ++k) {
      if (w_.factor.held(6 + k)) continue;
      for (const double sign : {1.0, -1.0})
        if (sign * x[6 + k] < bound(k, sign) && !has(k, sign)) add({k, sign, bound(k, sign)});
    }
    return n_ > before;
  }

  /// x with the impulses of the rows; on a velocity they do the work sum lambda sign (x + x') / 2.
  VecMax<double> meet(const VecMax<double>& x, double* work) {
    const auto n = static_cast<Eigen::Index>(n_);
    MatMax<double, kMaxLimitRows> W(n, n);
    VecMax<double, kMaxLimitRows> b(n);
    for (std::size_t i = 0; i < n_; ++i) {
      const Row& row = rows_[i];
      const auto r = static_cast<Eigen::Index>(i);
      b[r] = row.sign * x[6 + row.k] - row.bound;
      for (std::size_t j = 0; j < n_; ++j)
        W(r, static_cast<Eigen::Index>(j)) = row.sign * responses_[j][6 + row.k];
    }
    lambda_ = solve_complementarity(W, b).lambda;
    VecMax<double> after = x;
    for (std::size_t i = 0; i < n_; ++i)
      if (pushed(i)) after += responses_[i] * lambda_[static_cast<Eigen::Index>(i)];
    for (std::size_t i = 0; i < n_; ++i) {
      const Row& row = rows_[i];
      if (!pushed(i)) continue;
      after[6 + row.k] = row.sign * row.bound;  // to the last bit
      if (work != nullptr)
        *work += lambda_[static_cast<Eigen::Index>(i)] * row.sign * 0.5 * (x[6 + row.k] + after[6 + row.k]);
    }
    return after;
  }
  /// The rows that the last meet() pushed.
  template <class F>
  int for_each_pushed(F&& act) const {
    int count = 0;
    for (std::size_t i = 0; i < n_; ++i)
      if (pushed(i)) {
        act(rows_[i]);
        ++count;
      }
    return count;
  }

 private:
  bool pushed(std::size_t i) const { return lambda_[static_cast<Eigen::Index>(i)] > 0; }
  bool has(int k, double sign) const {
    for (std::size_t i = 0; i < n_; ++i)
      if (rows_[i].k == k && rows_[i].sign == sign) return true;
    return false;
  }

  const PartModel& m_;
  const PartWorkspace<double>& w_;
  std::size_t n_ = 0;
  std::array<Row, kMaxLimitRows> rows_;
  std::array<VecMax<double>, kMaxLimitRows> responses_;  ///< M^-1 e_k sign
  VecMax<double, kMaxLimitRows> lambda_;
};

/// The same with every row of bound(k, sign) that is passed, if only by what the others push.
template <class Bound>
VecMax<double> meet_all(LimitRows& rows, const VecMax<double>& x, Bound&& bound, double* work) {
  VecMax<double> now = x;
  while (rows.add_unmet(now, bound)) now = rows.meet(x, nullptr);
  return rows.empty() ? now : rows.meet(x, work);
}

void take_velocity(const PartModel& m, const PartWorkspace<double>& w, const VecMax<double>& v_r,
                   VecX<double>& v) {
  v.segment<3>(m.v0) = w.R * v_r.head<3>();
  v.segment(m.v0 + 3, 3 + m.n_s) = v_r.tail(3 + m.n_s);
}
VecMax<double> body_velocity(const PartModel& m, const PartWorkspace<double>& w, const VecX<double>& v) {
  VecMax<double> v_r(6 + m.n_s);
  v_r.head<3>() = w.R.transpose() * v.segment<3>(m.v0);
  v_r.tail(3 + m.n_s) = v.segment(m.v0 + 3, 3 + m.n_s);
  return v_r;
}

/// New velocities for parts whose coordinates were set back: their generalised momenta M v stay, and with
/// them P and L. work: evaluated at the coordinates before; left at those now.
void keep_momenta(const Dynamics& dynamics, double t, const std::vector<bool>& moved, const State& before,
                  State& state, Workspace<double>& work) {
  const auto& parts = dynamics.model().parts();
  std::vector<VecMax<double>> momenta(parts.size());
  std::vector<Mat3<double>> R(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!moved[i]) continue;
    momenta[i] = work.parts[i].inertia.M * work.parts[i].v_r;
    R[i] = work.parts[i].R;
  }
  dynamics.accelerations(t, state.q, state.v, state.at_limit, work);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const PartModel& m = parts[i];
    if (!moved[i]) continue;
    const PartWorkspace<double>& w = work.parts[i];
    const Vec3<double> P = R[i] * momenta[i].head<3>();
    const Vec3<double> slid = before.q.segment<3>(m.q0) - state.q.segment<3>(m.q0);
    const Vec3<double> L = R[i] * momenta[i].segment<3>(3) + slid.cross(P);
    VecMax<double> v_r = momenta[i];
    v_r.head<3>() = w.R.transpose() * P;
    v_r.segment<3>(3) = w.R.transpose() * L;
    Dynamics::apply_impulse(w, v_r);
    take_velocity(m, w, v_r, state.v);
  }
}

}  // namespace

void stop_at_limits_ahead(const Model& model, const Workspace<double>& work, State& state, double h,
                          StepCounters& counters) {
  for (std::size_t i = 0; i < model.parts().size(); ++i) {
    const PartModel& m = model.parts()[i];
    if (m.n_s == 0) continue;
    auto then = [&](int k) { return state.q[m.q0 + 7 + k] + h * state.v[m.v0 + 6 + k]; };
    auto at = [&](int k) -> std::int8_t& { return state.at_limit[static_cast<std::size_t>(m.limit0 + k)]; };
    // The velocity that would just reach a limit at the end of the step.
    auto bound = [&](int k, double sign) {
      const Range range = limits_of(m, k);
      return sign * ((sign > 0 ? range.min : range.max) - state.q[m.q0 + 7 + k]) / h;
    };
    LimitRows rows(m, work.parts[i]);
    bool crosses = false;
    for (int k = 0; k < m.n_s; ++k) crosses = crosses || !limits_of(m, k).contains(then(k));
    if (crosses) {
      const VecMax<double> v_r = meet_all(rows, body_velocity(m, work.parts[i], state.v), bound,
                                          &state.work[static_cast<int>(Work::limits)]);
      take_velocity(m, work.parts[i], v_r, state.v);
    }
    for (int k = 0; k < m.n_s; ++k) {
      at(k) = then(k) <= limits_of(m, k).min ? -1 : (then(k) >= limits_of(m, k).max ? 1 : 0);
      // A rate too small to leave the limit is rounding of the impulses of others: it rests.
      if (at(k) != 0 && then(k) == state.q[m.q0 + 7 + k]) state.v[m.v0 + 6 + k] = 0;
    }
    if (!rows.empty())
      counters.limit_impulses +=
          rows.for_each_pushed([&](const Row& row) { at(row.k) = row.sign > 0 ? -1 : 1; });
  }
}

void settle_on_limits(const Model& model, State& state) {
  for (const PartModel& m : model.parts())
    for (int k = 0; k < m.n_s; ++k) {
      const std::int8_t at = state.at_limit[static_cast<std::size_t>(m.limit0 + k)];
      const Range range = limits_of(m, k);
      if (at != 0) state.q[m.q0 + 7 + k] = at < 0 ? range.min : range.max;
    }
}

void stop_at_limits(const Dynamics& dynamics, double t, State& state, Workspace<double>& work,
                    StepCounters& counters) {
  const Model& model = dynamics.model();
  bool any = false;
  for (const PartModel& m : model.parts())
    for (int k = 0; k < m.n_s && !any; ++k) {
      const std::int8_t at = state.at_limit[static_cast<std::size_t>(m.limit0 + k)];
      any = (at != 0 && state.v[m.v0 + 6 + k] != 0) || !limits_of(m, k).contains(state.q[m.q0 + 7 + k]);
    }
  if (!any || !state.q.allFinite() || !state.v.allFinite()) return;

  const double before = dynamics.ledger(t, state, work).energy();
  const State passed = state;
  std::vector<bool> moved(model.parts().size(), false);
  bool any_moved = false;
  for (std::size_t i = 0; i < model.parts().size(); ++i) {
    const PartModel& m = model.parts()[i];
    if (m.n_s == 0) continue;
    // Positions: the least motion in the mass metric that closes every overshoot, and passes no other limit.
    auto gap = [&](int k, double sign) {
      const Range range = limits_of(m, k);
      return sign * ((sign > 0 ? range.min : range.max) - state.q[m.q0 + 7 + k]);
    };
    LimitRows overshot(m, work.parts[i]);
    const VecMax<double> shift = meet_all(overshot, VecMax<double>::Zero(6 + m.n_s), gap, nullptr);
    if (overshot.empty()) continue;
    moved[i] = any_moved = true;
    VecX<double> move = VecX<double>::Zero(state.v.size());
    take_velocity(m, work.parts[i], shift, move);
    advance_part(m, state.q, move, 1);
    overshot.for_each_pushed([&](const Row& row) {
      const Range range = limits_of(m, row.k);
      state.q[m.q0 + 7 + row.k] = row.sign > 0 ? range.min : range.max;
    });
  }
  if (any_moved) keep_momenta(dynamics, t, moved, passed, state, work);

  // Velocities: what is on a limit may only leave it.
  for (std::size_t i = 0; i < model.parts().size(); ++i) {
    const PartModel& m = model.parts()[i];
    const PartWorkspace<double>& w = work.parts[i];
    auto at = [&](int k) -> std::int8_t& { return state.at_limit[static_cast<std::size_t>(m.limit0 + k)]; };
    LimitRows on(m, w);
    bool outward = false;
    for (int k = 0; k < m.n_s; ++k) {
      const Range range = limits_of(m, k);
      double& q = state.q[m.q0 + 7 + k];
      at(k) = q <= range.min ? -1 : (q >= range.max ? 1 : 0);
      if (at(k) == 0) continue;
      q = at(k) < 0 ? range.min : range.max;
      if (w.factor.held(6 + k)) continue;
      on.add({k, at(k) < 0 ? 1.0 : -1.0, 0});
      outward = outward || at(k) * state.v[m.v0 + 6 + k] > 0;
    }
    if (outward) {
      take_velocity(m, w, on.meet(body_velocity(m, w, state.v), nullptr), state.v);
      counters.limit_impulses += on.for_each_pushed([](const Row&) {});
    }
    for (int k = 0; k < m.n_s; ++k)
      if (at(k) * state.v[m.v0 + 6 + k] < 0) at(k) = 0;  // it leaves
  }
  state.work[static_cast<int>(Work::limits)] += dynamics.ledger(t, state, work).energy() - before;
}

}  // namespace pliant
