// Function bodies of contact_problem.h: the contacts, limits and strings of a CoulombSystem, and the changes
// of velocity that their impulses cause, with the reactions of joints. A mover is a part, an island (parts
// that joints connect) or a mesh node that impulses move (movers.h).
#pragma once

#include <pliant/contact/contact_problem.h>

#include <algorithm>
#include <array>
#include <utility>

#include <pliant/body/constraint/group.h>
#include <pliant/body/speed_scale.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>
#include <pliant/part/local/modal_deformation.h>

namespace pliant {

namespace contact_problem {

/// Joints fix a contact if its normal response to a normal impulse (change of relative velocity per impulse)
/// is below this share of its response without joints. Such a contact gets no impulse: a corner of a hinged
/// part at the level of the hinge would otherwise stop the part by an arbitrarily large impulse.
inline constexpr double kFixedShare = 1e-9;

/// Returns the normal and two tangents of a contact as columns, unit vectors, world.
inline Mat3<double> axes(const Contact& contact) {
  const Vec3<double> t = contact.normal.unitOrthogonal();
  Mat3<double> axes;
  axes << contact.normal, t, contact.normal.cross(t);
  return axes;
}

/// A parameter is at a limit if its distance from the limit, as a displacement, is at most this share of the
/// size of the part.
inline constexpr double kAtLimit = 1e-6;

/// Sets `all` to the factors that convert the velocities of a part or island to comparable speeds (m/s). A
/// rotation by 1 rad is equivalent to a displacement by four sizes of the part, twice its extent. With a
/// smaller weight of rotations, slender bodies that fall flat on a plane turn out of the plane of their
/// motion.
inline void set_levers(const Model& model, const Movers& movers, const Mover& mover, VecX<double>& all) {
  constexpr double of_displacement = 0.25;
  all.setConstant(mover.size, of_displacement);
  for (const int part : mover.parts()) {
    const PartModel& m = model.parts()[at(part)];
    const int first = Movers::first_in(mover, part);
    for (int k = 3; k < 6 + m.n_s; ++k) all[first + k] = lever(m, k);
    if (const int n = movers.n_local(part); n > 0)
      all.segment(movers.first_local(mover, part), n) = of_displacement * local_levers(m).head(n);
  }
}

}  // namespace contact_problem

PLIANT_INLINE int near_limit(const PartModel& m, int k, const State& state) {
  const int mode = state.at_limit[at(m.limit0 + k)];
  if (mode != 0) return mode;
  const Range& limits = m.limits[at(k)];
  const double distance = contact_problem::kAtLimit * m.size / lever(m, 6 + k), value = state.q[m.q0 + 7 + k];
  if (value - limits.min <= distance) return -1;
  return limits.max - value <= distance ? 1 : 0;
}

PLIANT_INLINE ContactProblem::ContactProblem(const Model& model, const State& state, Workspace<double>& work,
                                             const std::vector<Contact>& contacts, const State* start)
    : model_(model), state_(state), work_(work), contacts_(contacts), movers_(model, work) {
  axes_.reserve(contacts.size());
  system_.reserve(contacts.size());
  for (const Contact& contact : contacts) {
    axes_.push_back(contact_problem::axes(contact));
    const Mat3<double> to_contact = axes_.back().transpose();
    system_.add_contact(contact.friction);
    add_side(contact.a, contact.x, to_contact);
    if (contact.b.part >= 0) add_side(contact.b, contact.x, -to_contact);
    complete();
  }
  add_limits(start);
  add_strings();
  before_ = movers_.velocities(state, work);
  after_ = before_;
  shift_.setZero(movers_.n_x());
  add_predicted();
}

/// Computes the changes of velocity by the predicted impulses.
PLIANT_INLINE void ContactProblem::add_predicted() {
  for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) {
    if (contacts_[at(k)].predicted.isZero(0)) continue;
    if (predicted_.size() == 0) predicted_.setZero(movers_.n_x());
    warm_start_at(k, contacts_[at(k)].predicted);
    system_.add_change(k, 1, predicted_);
    system_.impulse(k).setZero();
  }
}

/// Adds a side of the contact that is being added. x: the contact point, m, world. to_contact: matrix from
/// the world to the axes of the contact, with a minus sign for side b.
PLIANT_INLINE void ContactProblem::add_side(const ContactSide& side, const Vec3<double>& x,
                                            const Mat3<double>& to_contact) {
  const PartModel& m = model_.parts()[at(side.part)];
  if (m.q0 < 0) return;
  const PartWorkspace<double>& w = work_.parts[at(side.part)];
  if (side.at_nodes() && moves_by_nodes(m, w)) {
    for (std::size_t k = 0; k < side.node.size() && side.node[k] >= 0; ++k)
      sides_.push_back({side.part,
                        movers_.mover_of_node(side.part, side.node[k]),
                        0,
                        side.weight[static_cast<Eigen::Index>(k)] * to_contact,
                        {}});
    return;
  }
  Side s = make_side(side.part);
  const Mat3<double> D = to_contact * w.R;
  s.J.leftCols<3>() = D;
  s.J.middleCols<3>(3) = -D * skew<double>(w.R.transpose() * (x - w.c));
  if (m.n_s > 0) {
    std::vector<Material<double>> points{side.material};
    for (std::size_t k = 0; k < side.node.size() && side.node[k] >= 0; ++k) {
      points.resize(k + 1);
      points[k] = m.local->mesh().nodes[at(side.node[k])];
    }
    Counters counters;
    m.part->points(points, w.q_s, w.q_s_dot, jets_, counters);
    for (std::size_t k = 0; k < points.size(); ++k)
      s.J.rightCols(m.n_s) += side.weight[static_cast<Eigen::Index>(k)] * D * jets_[k].J;
  }
  if (m.local != nullptr) add_local(side, D, s);
  sides_.push_back(std::move(s));
}

/// Returns a side with J = 0. The mover of the side is the part or its island, not a node.
PLIANT_INLINE ContactProblem::Side ContactProblem::make_side(int part) {
  const int mover = movers_.mover_of_part(part);
  Side side{part, mover, Movers::first_in(movers_[mover], part), {}, {}};
  side.J.setZero(3, 6 + model_.parts()[at(part)].n_s);
  return side;
}

/// Adds the columns of J for local coordinates to a side. D: 3 x 3, from the body frame to the axes of the
/// contact, negative for side b.
PLIANT_INLINE void ContactProblem::add_local(const ContactSide& side, const Mat3<double>& D, Side& to) const {
  const LocalDeformation& local = *model_.parts()[at(side.part)].local;
  const int first = movers_.first_local(movers_[to.mover], side.part),
            n = static_cast<int>(local.mesh().X.rows());
  for (std::size_t k = 0; k < side.node.size() && side.node[k] >= 0; ++k) {
    const Mat3<double> share = side.weight[static_cast<Eigen::Index>(k)] * D;
    if (local.modal() != nullptr) {
      to.local.push_back({first, share * local.modal()->modes_of_node(side.node[k])});
      continue;
    }
    for (int r = 0; r < 3; ++r) to.local.push_back({first + side.node[k] + r * n, share.col(r)});
  }
}

/// Adds a one-sided row for each parameter of the movers that is at a limit, now or at the start of the
/// motion: the parameter must not pass the limit. Parameters without inertia, and parameters of parts that
/// move by nodes, get no row.
PLIANT_INLINE void ContactProblem::add_limits(const State* start) {
  for (const Mover& mover : movers_.all()) {  // the new rows add no movers
    if (mover.node >= 0) continue;
    for (const int part : mover.parts()) {
      const PartModel& m = model_.parts()[at(part)];
      for (int k = 0; k < m.n_s; ++k) {
        int mode = state_.at_limit[at(m.limit0 + k)];
        if (mode == 0 && start != nullptr) mode = near_limit(m, k, *start);
        if (moves_by_nodes(m, work_.parts[at(part)]) || mode == 0 ||
            work_.parts[at(part)].without_inertia(6 + k))
          continue;
        system_.add_limit();
        Side side = make_side(part);
        side.J(0, 6 + k) = -mode * lever(m, 6 + k);  // so that the row is a speed, like rows of contacts
        sides_.push_back(std::move(side));
        complete();
      }
    }
  }
}

/// Adds a one-sided row for each taut string at the movers: the string must not become longer. Strings of
/// parts that deform locally get no row; the projection of joints treats them.
PLIANT_INLINE void ContactProblem::add_strings() {
  for (const Mover& mover : movers_.all()) {  // the new rows add no movers
    if (mover.island == nullptr) continue;
    for (const int j : mover.island->strings) {
      const JointModel& string = model_.joints()[at(j)];
      if (state_.joints[at(j)] != JointMode::closed ||
          std::any_of(string.sides.begin(), string.sides.end(),
                      [&](const JointSide& side) { return model_.parts()[at(side.part)].local != nullptr; }))
        continue;
      strings_.push_back({system_.size(), string.row});
      system_.add_row();
      for (const JointSide& end : string.sides) {
        Side side = make_side(end.part);
        side.J.row(0) = work_.joints.Cq.segment(end.offset, side.J.cols()).transpose();
        sides_.push_back(std::move(side));
      }
      complete();
    }
  }
}

/// Completes the last contact, limit or string: adds its sides, and the responses of the movers with the
/// reactions of joints. If joints fix the contact (kFixedShare), it gets no responses and thus no impulse.
PLIANT_INLINE void ContactProblem::complete() {
  const int contact = system_.size() - 1, rows = system_.rows(contact);
  while (system_.movers() < static_cast<int>(movers_.all().size()))
    system_.add_mover(movers_[system_.movers()].size);
  for (const Side& side : sides_) {
    system_.add_side(side.mover, side.first, static_cast<int>(side.J.cols())) = side.J;
    for (const Side::Local& local : side.local)
      system_.add_side(side.mover, local.first, static_cast<int>(local.J.cols())) = local.J;
  }
  bool jointed = false;
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const int number = sides_[i].mover;
    if (std::any_of(sides_.begin(), sides_.begin() + static_cast<std::ptrdiff_t>(i),
                    [&](const Side& side) { return side.mover == number; }))
      continue;
    const Mover& mover = movers_[number];
    jointed = jointed || mover.island != nullptr;
    CoulombSystem::Push Y = system_.add_push(number);
    for (std::size_t k = i; k < sides_.size(); ++k)
      if (sides_[k].mover == number) add_response(mover, sides_[k], rows, Y);
  }
  const double free_response = system_.effect(contact, contact)(0, 0);
  double response = free_response;
  if (jointed) {
    add_joint_responses(contact);
    response = system_.effect(contact, contact)(0, 0);
  }
  if (!(response > contact_problem::kFixedShare * free_response)) {
    system_.drop_pushes();
    while (!joints_.empty() && joints_.back().contact == contact) joints_.pop_back();
  }
  sides_.clear();
}

/// Adds to Y the change of the velocities of a mover by unit impulses at a side, without the reactions of
/// joints. Y: one column for each row of the contact. rows: number of these rows.
PLIANT_INLINE void ContactProblem::add_response(const Mover& mover, const Side& side, int rows,
                                                CoulombSystem::Push& Y) {
  if (mover.node >= 0) {
    Y += side.J.transpose() / model_.parts()[at(mover.part)].local->mesh().mass[mover.node];
    return;
  }
  const PartModel& m = model_.parts()[at(side.part)];
  if (const int n = movers_.n_local(side.part); n > 0) {
    const LocalWorkspace& w = *work_.parts[at(side.part)].local;
    const int first = movers_.first_local(mover, side.part);
    for (int r = 0; r < rows; ++r) {
      VecX<double> frame = side.J.row(r).transpose(), rates = VecX<double>::Zero(n), buffer;
      for (const Side::Local& local : side.local)
        rates.segment(local.first - first, local.J.cols()) += local.J.row(r).transpose();
      if (w.response != nullptr)
        w.response->respond(frame, rates);
      else
        m.local->modal()->respond(frame, rates, w);
      Y.col(r).segment(side.first, frame.size()) += frame;
      Y.col(r).segment(side.first + frame.size(), m.n_x() - frame.size()) +=
          at_points(m.joint_points, m.local->at_nodes(rates.data(), buffer));
      Y.col(r).segment(first, n) += rates;
    }
    return;
  }
  if (const Eigen::Matrix<double, 6, 6>* inverse = work_.parts[at(side.part)].rigid_mass_inverse()) {
    Y.middleRows<6>(side.first) += *inverse * side.J.leftCols<6>().transpose();
    return;
  }
  for (int r = 0; r < rows; ++r) {
    force_.setZero(m.n_x());  // no impulse at attachment points of joints
    force_.head(side.J.cols()) = side.J.row(r).transpose();
    work_.parts[at(side.part)].solve_mass(force_);
    Y.col(r).segment(side.first, m.n_x()) += force_;
  }
}

/// Adds the reactions of the joints of islands to the responses of a contact.
PLIANT_INLINE void ContactProblem::add_joint_responses(int contact) {
  for (int i = 0; i < system_.pushes(contact); ++i) {
    const Mover& mover = movers_[system_.pushed(contact, i)];
    const Island* island = mover.island;
    if (island == nullptr) continue;
    CoulombSystem::Push Y = system_.push(contact, i);
    const Group<double, Eigen::Dynamic> group(model_, work_, *island, true);
    JointResponse response{contact, island, MatX<double>::Zero(island->rows, system_.rows(contact))};
    for (int r = 0; r < system_.rows(contact); ++r) {
      const VecX<double> free = Y.col(r).head(island->n_v);
      VecX<double> x = free, rows;
      for (int round = 0; round < (group.is_rough() ? 2 : 1); ++round) {
        group.joint_rows(x, rows);
        response.lambda.col(r) += group.correct(rows, x);
      }
      Y.col(r).head(island->n_v) = x;
      x -= free;
      for (std::size_t k = 0; k < island->parts.size(); ++k) {
        const int part = island->parts[k];
        const PartModel& m = model_.parts()[at(part)];
        if (movers_.n_local(part) == 0) continue;
        const LocalWorkspace& w = *work_.parts[at(part)].local;
        m.local->push_all(m.joint_points, w.A_inverse * x.segment(island->first[k], m.n_x()), w,
                          Y.col(r).segment(movers_.first_local(mover, part), m.n_d()));
      }
    }
    joints_.push_back(std::move(response));
  }
}

PLIANT_INLINE std::vector<Vec3<double>> ContactProblem::velocities(const State& state) const {
  const VecX<double> x = movers_.velocities(state, work_);
  std::vector<Vec3<double>> all;
  all.reserve(contacts_.size());
  for (int k = 0; k < static_cast<int>(contacts_.size()); ++k)
    all.push_back(axes_[at(k)] * (system_.velocity(k, x) - system_.constant(k)) -
                  contacts_[at(k)].prescribed_velocity);
  return all;
}

PLIANT_INLINE ContactSolution ContactProblem::solve(double limit_time) {
  const int n = static_cast<int>(contacts_.size());
  for (int k = 0; k < n; ++k) {
    const Contact& contact = contacts_[at(k)];
    system_.constant(k) = -axes_[at(k)].transpose() * contact.prescribed_velocity;
    system_.constant(k)[0] -= contact.rebound;
  }
  for (const String& string : strings_) {
    double& along = system_.constant(string.contact)[0];
    // The constant is C_dot of the string when all movers are at rest, m/s. It comes from prescribed ends.
    // system_.velocity() includes the constant, which is therefore set to zero first.
    along = 0;
    along = work_.joints.C_dot[string.row] - system_.velocity(string.contact, before_)[0];
  }
  if (has_predicted()) after_ -= predicted_;
  const CoulombResult result = system_.solve(after_, {0, model_.body().contact.tolerance});
  ContactSolution solution{
      {}, {}, result.residual, result.worst_residual, result.worst_accepted, result.sweeps, result.fallbacks};
  solution.impulse.reserve(contacts_.size());
  solution.velocity.reserve(contacts_.size());
  for (int k = 0; k < system_.size(); ++k) {
    system_.add_change(k, k < n ? contacts_[at(k)].since : limit_time, shift_);
    if (k >= n) continue;
    const Mat3<double>& to_world = axes_[at(k)];
    Vec3<double> u = system_.velocity(k, after_);
    u[0] += contacts_[at(k)].rebound;
    solution.impulse.push_back(to_world * system_.impulse(k));
    solution.velocity.push_back(to_world * u);
  }
  return solution;
}

PLIANT_INLINE void ContactProblem::warm_start_at(int contact, const Vec3<double>& impulse) {
  system_.impulse(contact) = axes_[at(contact)].transpose() * impulse;
}

PLIANT_INLINE void ContactProblem::add_joint_impulses(VecX<double>& rows) const {
  for (const JointResponse& response : joints_) {
    const VecX<double> lambda =
        response.lambda * system_.impulse(response.contact).head(response.lambda.cols());
    for (const int j : response.island->joints) {
      const JointModel& joint = model_.joints()[at(j)];
      rows.segment(joint.row, joint.rows) += lambda.segment(joint.island_row, joint.rows);
    }
  }
  for (const String& string : strings_) rows[string.row] += system_.impulse(string.contact)[0];
}

PLIANT_INLINE void ContactProblem::bound_shifts(double limit_time, double max_time) {
  VecX<double> change, levers;
  for (const Mover& mover : movers_.all()) {
    auto displacement = shift_.segment(mover.first, mover.size);
    change = after(mover) - before(mover);
    if (has_predicted()) change += predicted_.segment(mover.first, mover.size);
    const bool too_far = [&] {
      if (mover.node >= 0) return displacement.norm() > max_time * change.norm();
      contact_problem::set_levers(model_, movers_, mover, levers);
      return levers.cwiseProduct(displacement).norm() > max_time * levers.cwiseProduct(change).norm();
    }();
    if (too_far) displacement = limit_time * change;
  }
  if (has_predicted()) shift_ -= max_time * predicted_;
}

PLIANT_INLINE double ContactProblem::own_speed(int contact) const {
  return (system_.effect(contact, contact) * axes_[at(contact)].transpose() *
          contacts_[at(contact)].predicted)[0];
}

PLIANT_INLINE std::vector<double> ContactProblem::close_gaps() {
  const int n = static_cast<int>(contacts_.size());
  auto movers_of = [&](int k) {
    std::array<int, 2> numbers{-1, -1};
    const Contact& contact = contacts_[at(k)];
    if (!(contact.lift > 0) || !(system_.impulse(k)[0] > 0)) return numbers;
    for (const bool second : {false, true}) {
      const int part = second ? contact.b.part : contact.a.part;
      if (part >= 0 && model_.parts()[at(part)].q0 >= 0) numbers[second] = movers_.mover_of_part(part);
    }
    return numbers;
  };
  std::vector<int> sharing(movers_.all().size(), 0);  // number of contacts with predicted impulses at a mover
  for (int k = 0; k < n; ++k)
    for (const int mover : movers_of(k))
      if (mover >= 0) ++sharing[at(mover)];
  std::vector<double> impulses(at(n), 0);
  VecX<double> displacements = VecX<double>::Zero(movers_.n_x());
  for (int k = 0; k < n; ++k) {
    int connected = 0;  // number of contacts with predicted impulses at both movers of contact k
    for (const int mover : movers_of(k))
      if (mover >= 0) connected += sharing[at(mover)] - (connected > 0 ? 1 : 0);  // contact k is counted once
    if (connected == 0) continue;
    system_.constant(k).setZero();  // the constant is a velocity, and shift_ is a displacement
    const double gap = contacts_[at(k)].gap + system_.velocity(k, shift_)[0];
    if (!(std::abs(gap) <= contacts_[at(k)].lift)) continue;  // the prediction has not caused this gap
    impulses[at(k)] = -gap / (system_.effect(k, k)(0, 0) * connected);
    const Vec3<double> impulse = std::exchange(system_.impulse(k), Vec3<double>(impulses[at(k)], 0, 0));
    system_.add_change(k, 1, displacements);
    system_.impulse(k) = impulse;
  }
  shift_ += displacements;
  return impulses;
}

PLIANT_INLINE void ContactProblem::separate_bodies(const std::vector<double>& max_separation,
                                                   double tolerance) {
  for (int k = 0; k < system_.size(); ++k) {
    system_.set_friction(k, 0);
    system_.impulse(k).setZero();
    system_.constant(k).setZero();
    if (k < static_cast<int>(contacts_.size()))
      system_.constant(k)[0] =
          std::max(contacts_[at(k)].gap + system_.velocity(k, shift_)[0], -max_separation[at(k)]);
  }
  VecX<double> separation = VecX<double>::Zero(movers_.n_x());
  system_.solve(separation, {tolerance});
  shift_ += separation;
}

}  // namespace pliant
