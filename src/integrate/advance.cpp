#include <pliant/integrate/advance.h>

#include <cmath>
#include <vector>

#include <pliant/math/sinc.h>
#include <pliant/solve/complementarity.h>

namespace pliant {

void advance_coordinates(const Model& model, VecX<double>& q, const VecX<double>& v, double h) {
  for (const PartModel& m : model.parts()) {
    if (m.q0 < 0) continue;
    q.segment<3>(m.q0) += h * v.segment<3>(m.v0);
    const Vec3<double> half = 0.5 * h * v.segment<3>(m.v0 + 3);
    const double angle = half.norm();
    const Vec3<double> axis = sinc(angle) * half;
    const Eigen::Quaterniond turn(std::cos(angle), axis[0], axis[1], axis[2]);
    auto theta = q.segment<4>(m.q0 + 3);
    const Eigen::Quaterniond now =
        (Eigen::Quaterniond(theta[0], theta[1], theta[2], theta[3]) * turn).normalized();
    theta << now.w(), now.x(), now.y(), now.z();
    q.segment(m.q0 + 7, m.n_s) += h * v.segment(m.v0 + 6, m.n_s);
  }
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

/// One-sided rows of a part: parameter k may not leave its limit; sign is the admissible direction.
struct Row {
  int k;
  double sign;
  double gap;       ///< distance to the limit, >= 0 inside
  double velocity;  ///< least velocity along sign
};

Range limits_of(const PartModel& m, int k) {
  return m.part->parameters()[m.part->parameters().dynamic()[static_cast<std::size_t>(k)]].limits;
}

/// Solves the rows and adds the impulses to the velocities of the part (body-frame v_r); returns the work
/// done.
double resolve(const PartModel& m, const PartWorkspace<double>& w, const std::vector<Row>& rows,
               VecMax<double>& v_r, StepCounters& counters) {
  const auto n = static_cast<Eigen::Index>(rows.size());
  MatX<double> W(n, n);
  VecX<double> b(n);
  std::vector<VecMax<double>> columns;
  for (const Row& row : rows) {
    VecMax<double> impulse = VecMax<double>::Zero(6 + m.n_s);
    impulse[6 + row.k] = row.sign;
    Dynamics::apply_impulse(w, impulse);
    columns.push_back(impulse);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const Row& row = rows[static_cast<std::size_t>(i)];
    b[i] = row.sign * v_r[6 + row.k] - row.velocity;
    for (Eigen::Index j = 0; j < n; ++j) W(i, j) = row.sign * columns[static_cast<std::size_t>(j)][6 + row.k];
  }
  const VecX<double> lambda = solve_complementarity(W, b).lambda;
  const VecMax<double> before = v_r;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!(lambda[i] > 0)) continue;
    v_r += columns[static_cast<std::size_t>(i)] * lambda[i];
    ++counters.limit_impulses;
  }
  double work = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Row& row = rows[static_cast<std::size_t>(i)];
    work += lambda[i] * row.sign * 0.5 * (before[6 + row.k] + v_r[6 + row.k]);
  }
  return work;
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

}  // namespace

void stop_at_limits_ahead(const Model& model, const Workspace<double>& work, State& state, double h,
                          StepCounters& counters) {
  for (std::size_t i = 0; i < model.parts().size(); ++i) {
    const PartModel& m = model.parts()[i];
    if (m.n_s == 0) continue;
    std::vector<Row> rows;
    bool crosses = false;
    for (int k = 0; k < m.n_s; ++k) {
      if (work.parts[i].factor.held(6 + k)) continue;
      const Range range = limits_of(m, k);
      const double q = state.q[m.q0 + 7 + k], reach = std::abs(h * state.v[m.v0 + 6 + k]);
      // A row for every limit that this step could touch, with room for what the other rows push.
      if (q - range.min <= 2 * reach) rows.push_back({k, 1, q - range.min, (range.min - q) / h});
      if (range.max - q <= 2 * reach) rows.push_back({k, -1, range.max - q, (q - range.max) / h});
      const double then = q + h * state.v[m.v0 + 6 + k];
      crosses = crosses || then < range.min || then > range.max;
    }
    if (crosses) {
      VecMax<double> v_r = body_velocity(m, work.parts[i], state.v);
      state.work[static_cast<int>(Work::limits)] += resolve(m, work.parts[i], rows, v_r, counters);
      take_velocity(m, work.parts[i], v_r, state.v);
    }
    for (int k = 0; k < m.n_s; ++k) {
      const Range range = limits_of(m, k);
      double& v = state.v[m.v0 + 6 + k];
      const double q = state.q[m.q0 + 7 + k], then = q + h * v, near = 1e-12 * (range.max - range.min);
      std::int8_t& at = state.at_limit[static_cast<std::size_t>(m.limit0 + k)];
      at = 0;
      if (then <= range.min + near) at = -1;
      if (then >= range.max - near) at = 1;
    }
  }
}

void stop_at_limits(const Dynamics& dynamics, State& state, Workspace<double>& work, StepCounters& counters) {
  const Model& model = dynamics.model();
  bool any = false;
  for (const PartModel& m : model.parts())
    for (int k = 0; k < m.n_s && !any; ++k) {
      const Range range = limits_of(m, k);
      const double q = state.q[m.q0 + 7 + k], v = state.v[m.v0 + 6 + k];
      const std::int8_t at = state.at_limit[static_cast<std::size_t>(m.limit0 + k)];
      any = q < range.min || q > range.max || (at < 0 && v != 0) || (at > 0 && v != 0);
    }
  if (!any) return;

  const double before = dynamics.ledger(state, work).energy();
  for (std::size_t i = 0; i < model.parts().size(); ++i) {
    const PartModel& m = model.parts()[i];
    const PartWorkspace<double>& w = work.parts[i];
    std::vector<Row> rows;
    for (int k = 0; k < m.n_s; ++k) {
      std::int8_t& at = state.at_limit[static_cast<std::size_t>(m.limit0 + k)];
      const Range range = limits_of(m, k);
      const double q = state.q[m.q0 + 7 + k];
      if (q <= range.min || at < 0) rows.push_back({k, 1, q - range.min, 0});
      if (q >= range.max || at > 0) rows.push_back({k, -1, range.max - q, 0});
      at = 0;
    }
    if (rows.empty()) continue;
    // Positions: the least motion in the mass metric that closes every overshoot.
    const auto n = static_cast<Eigen::Index>(rows.size());
    MatX<double> W(n, n);
    VecX<double> b(n);
    std::vector<VecMax<double>> columns;
    for (const Row& row : rows) {
      VecMax<double> push = VecMax<double>::Zero(6 + m.n_s);
      push[6 + row.k] = row.sign;
      Dynamics::apply_impulse(w, push);
      columns.push_back(push);
    }
    for (Eigen::Index r = 0; r < n; ++r) {
      b[r] = rows[static_cast<std::size_t>(r)].gap;
      for (Eigen::Index c = 0; c < n; ++c)
        W(r, c) = rows[static_cast<std::size_t>(r)].sign *
                  columns[static_cast<std::size_t>(c)][6 + rows[static_cast<std::size_t>(r)].k];
    }
    const VecX<double> lambda = solve_complementarity(W, b).lambda;
    VecMax<double> shift = VecMax<double>::Zero(6 + m.n_s);
    for (Eigen::Index r = 0; r < n; ++r) shift += columns[static_cast<std::size_t>(r)] * lambda[r];
    VecX<double> move = VecX<double>::Zero(state.v.size());
    take_velocity(m, w, shift, move);
    advance_coordinates(model, state.q, move, 1);
    // Velocities.
    VecMax<double> v_r = body_velocity(m, w, state.v);
    resolve(m, w, rows, v_r, counters);
    take_velocity(m, w, v_r, state.v);
    for (const Row& row : rows) {
      const Range range = limits_of(m, row.k);
      double& q = state.q[m.q0 + 7 + row.k];
      const double limit = row.sign > 0 ? range.min : range.max;
      const double near = 1e-10 * (std::isfinite(range.max - range.min) ? range.max - range.min : 1.0);
      if (std::abs(q - limit) > near || row.sign * state.v[m.v0 + 6 + row.k] > 0) continue;
      q = limit;
      state.v[m.v0 + 6 + row.k] = 0;
      state.at_limit[static_cast<std::size_t>(m.limit0 + row.k)] = row.sign > 0 ? -1 : 1;
    }
  }
  state.work[static_cast<int>(Work::limits)] += dynamics.ledger(state, work).energy() - before;
}

}  // namespace pliant
