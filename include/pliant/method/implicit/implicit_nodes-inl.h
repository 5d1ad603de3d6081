// Function bodies of implicit_nodes.h: the sparse factor of S, the border and its Schur complement, the
// filter and the responses to impulses.
#pragma once

#include <pliant/method/implicit/implicit_nodes.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/Cholesky>

#include <pliant/body/step_failure.h>
#include <pliant/math/header_only.h>
#include <pliant/math/scalar/power_of_two.h>

namespace pliant {

namespace implicit_nodes {

/// A pivot of S below kMinPivot times its entry of M indicates negative stiffness, as in a buckling sheet.
/// Mass is then added to S: first kFirstExtraMass times M, and in each further attempt kExtraMassGrowth times
/// the mass of the attempt before, up to kMaxExtraMass times M.
inline constexpr double kMinPivot = 0.5, kFirstExtraMass = 1, kMaxExtraMass = 1e12, kExtraMassGrowth = 4;
/// Size of the perturbation of the nodes, in sizes of the part. The sparsity pattern of K is found at the
/// rest shape with perturbed nodes, so that no entry is zero by chance.
inline constexpr double kPerturbation = 1e-7;

using Of = NodalEnergy::Of;
using Entries = std::vector<Eigen::Triplet<double>>;

/// A matrix of an energy: NodalEnergy::add_stiffness or NodalEnergy::add_viscosity.
using Matrix = void (NodalEnergy::*)(const Coordinates&, Entries&) const;

/// Calls add(row, column, value) for each contribution to the lower triangle of a matrix by the energies of
/// the kind `of`. x: positions or displacements of the nodes, depending on `of`, m. entries: scratch storage;
/// its contents are ignored.
template <class Add>
void for_each_entry(const NodalDeformation& local, Of of, Matrix matrix, const VecX<double>& x,
                    Entries& entries, Add&& add) {
  entries.clear();
  for (const auto& energy : local.energies())
    if (energy->of() == of) (*energy.*matrix)(x, entries);
  for (const Eigen::Triplet<double>& entry : entries)
    if (entry.row() >= entry.col()) add(entry.row(), entry.col(), entry.value());
}

/// Returns (K_p + w w^T) dx at positions x (m), with K_p and w of implicit_nodes.h.
inline VecX<double> stiffness_along(const NodalDeformation& local, const VecX<double>& x,
                                    const VecX<double>& dx) {
  VecX<double> f = VecX<double>::Zero(x.size());
  NodalEnergy::Buffer buffer;
  for (const auto& energy : local.energies())
    if (energy->of() == Of::position) energy->add_derivative(x, dx, f, buffer, nullptr);
  return -f;
}

/// Returns V_p dx at positions x (m), with V_p of implicit_nodes.h.
inline VecX<double> viscosity_along(const NodalDeformation& local, const VecX<double>& x,
                                    const VecX<double>& dx) {
  VecX<double> f = VecX<double>::Zero(x.size());
  NodalEnergy::Buffer buffer;
  for (const auto& energy : local.energies())
    if (energy->of() == Of::position) energy->add_viscous_force(x, dx, f, buffer, nullptr);
  return -f;
}

/// Returns the three columns -[d]x of delta = G - G0 at the nodes, which belong to the rotation. The other
/// columns of delta are zero.
inline MatX<double> turned_displacements(const NodalWorkspace& w, Eigen::Index n_d) {
  const Eigen::Index n = w.s.rows();
  MatX<double> delta = MatX<double>::Zero(n_d, 3);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    // Column i of -[d]x is e_i x d, with component -d_k along j and d_j along k.
    delta.col(i).segment(j * n, n) = -w.d.segment(k * n, n);
    delta.col(i).segment(k * n, n) = w.d.segment(j * n, n);
  }
  return delta;
}

/// Returns the vectors w of the dense terms that add_stiffness omits, one for each internal pressure.
inline std::vector<VecX<double>> dense_terms(const NodalDeformation& local, const VecX<double>& x) {
  std::vector<VecX<double>> all;
  for (const auto& energy : local.energies()) {
    VecX<double> w = energy->rank_one(x);
    if (w.size() > 0) all.push_back(std::move(w));
  }
  return all;
}

/// Returns the diagonal entry of column i of a lower triangle.
inline double& diagonal(SparseMatrix& A, Eigen::Index i) {
  return A.valuePtr()[A.outerIndexPtr()[i]];
}

}  // namespace implicit_nodes

PLIANT_INLINE ImplicitNodes::ImplicitNodes(const PartModel& part, std::unique_ptr<SparseFactor> factor)
    : ImplicitPart(part), factor_(std::move(factor)) {
  stiffness_changes_ = !local().stiffness_is_constant();
  VecX<double> q_s(part.n_s);
  for (int k = 0; k < part.n_s; ++k) q_s[k] = part.part->parameters().moving(k).rest_value();
  zeros_.setZero(local().n_d());
  rest_.place(zeros_.data(), zeros_.data(), zeros_.size());
  Counters unused;
  local().positions(*part.part, q_s, VecX<double>::Zero(6 + part.n_s), rest_, unused);
}

PLIANT_INLINE void ImplicitNodes::make_pattern() {
  const Eigen::Index n_d = local().n_d();
  VecX<double> perturbed = rest_.x;
  for (Eigen::Index i = 0; i < n_d; ++i)
    perturbed[i] += implicit_nodes::kPerturbation * part_->size * std::sin(static_cast<double>(i));
  implicit_nodes::Entries lower;
  for (int i = 0; i < n_d; ++i) lower.emplace_back(i, i, 0.0);
  implicit_nodes::for_each_entry(local(), implicit_nodes::Of::displacement, &NodalEnergy::add_stiffness,
                                 rest_.d, entries_,
                                 [&](int i, int j, double value) { lower.emplace_back(i, j, value); });
  implicit_nodes::for_each_entry(local(), implicit_nodes::Of::position, &NodalEnergy::add_stiffness,
                                 perturbed, entries_,
                                 [&](int i, int j, double) { lower.emplace_back(i, j, 0.0); });
  K_.resize(n_d, n_d);
  K_.setFromTriplets(lower.begin(), lower.end());
  K_.makeCompressed();
}

PLIANT_INLINE int ImplicitNodes::factor_definite(double factor, double t) {
  const VecX<double>& M = local().inertia();
  const VecX<double> stiffness = S_.diagonal();
  double extra_mass = 0;
  for (int attempt = 1; extra_mass <= implicit_nodes::kMaxExtraMass;
       ++attempt, extra_mass = std::max(implicit_nodes::kFirstExtraMass,
                                        implicit_nodes::kExtraMassGrowth * extra_mass)) {
    for (Eigen::Index i = 0; i < M.size(); ++i)
      implicit_nodes::diagonal(S_, i) = stiffness[i] + (factor + extra_mass) * M[i];
    if (!factor_->factor(S_)) continue;
    bool definite = true;
    for (Eigen::Index i = 0; i < M.size() && definite; ++i)
      definite = factor_->pivots()[static_cast<std::size_t>(i)] >= implicit_nodes::kMinPivot * M[i];
    if (definite) return attempt;
  }
  throw NumericalFailure(
      "the stiffness of the nodes of part '" + part_->part->name() + "' cannot be factored: it is not finite",
      t);
}

PLIANT_INLINE int ImplicitNodes::prepare(const PartWorkspace<double>& w, double c, double t) {
  const NodalWorkspace& nodal = NodalDeformation::of(*w.local);
  const bool refactor = stiffness_changes_ || c != c_ || nodal.law_factor != law_factor_;
  int factorisations = 0;
  if (refactor || frame_in_border()) {
    c_ = 0;  // marks the factor as invalid if the factorisation throws
    const std::string name = "the stiffness of the nodes of part '" + part_->part->name() + "'";
    law_factor_ = nodal.law_factor;
    try {
      if (refactor) factorisations = factor(c, nodal.x, t);
      make_border(nodal, c);
    } catch (const std::bad_alloc&) {
      throw OutOfMemory("out of memory for the factor of " + name + ", of " + std::to_string(local().n_d()) +
                        " unknowns");
    } catch (const StepFailure&) {
      throw;
    } catch (const std::runtime_error& failure) {
      throw NumericalFailure(name + " cannot be factored: " + failure.what(), t);
    }
    c_ = c;
  }
  if (refactor || frame_in_border()) make_core(nodal);
  if (!frame_in_border() && refactor)
    H0_inverse_ = w.local->H0.llt().solve(MatX<double>::Identity(n_r(), n_r()));
  return factorisations;
}

PLIANT_INLINE int ImplicitNodes::factor(double c, const VecX<double>& x, double t) {
  if (K_.size() == 0) make_pattern();
  const double beta = local().beta();
  S_ = K_;
  S_.coeffs() *= law_factor_ * c * (beta + c);
  if (stiffness_changes_) {
    const auto add = [&](implicit_nodes::Matrix matrix, double factor) {
      implicit_nodes::for_each_entry(
          local(), implicit_nodes::Of::position, matrix, x, entries_,
          [&](int i, int j, double value) { S_.coeffRef(i, j) += factor * value; });
    };
    add(&NodalEnergy::add_stiffness, law_factor_ * c * c);
    if (beta > 0) add(&NodalEnergy::add_viscosity, law_factor_ * c * beta);
  }
  if (!S_.isCompressed()) S_.makeCompressed();
  if (S_.nonZeros() != K_.nonZeros() || analysed_ != K_.nonZeros()) {
    factor_->analyse(S_);
    analysed_ = S_.nonZeros();
  }
  const int factorisations = factor_definite(1 + c * local().alpha(), t);
  const std::vector<NodeWeights>& points = part_->joint_points;
  if (points.empty()) return factorisations;
  const Eigen::Index n = local().n_nodes();
  Z_.setZero(local().n_d(), 3 * static_cast<Eigen::Index>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k)
    for (std::size_t i = 0; i < points[k].node.size(); ++i)
      for (int r = 0; r < 3; ++r)
        Z_(points[k].node[i] + r * n, 3 * static_cast<Eigen::Index>(k) + r) += points[k].weight[i];
  factor_->solve(Z_);
  return factorisations;
}

PLIANT_INLINE void ImplicitNodes::make_border(const NodalWorkspace& w, double c) {
  const Eigen::Index n = local().n_nodes(), n_d = local().n_d(), n_s = part_->n_s;
  const VecX<double>& m = local().mesh().mass;
  const std::vector<VecX<double>> dense = implicit_nodes::dense_terms(local(), w.x);
  const auto n_dense = static_cast<Eigen::Index>(dense.size());
  B_.setZero(n_d, n_r() + (frame_in_border() ? n_r() : 0) + n_dense);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    B_.col(i).segment(i * n, n) = m;
    // Column i of -[s]x is e_i x s, with component -s_k along j and s_j along k.
    B_.col(3 + i).segment(j * n, n) = -m.cwiseProduct(w.s.col(k));
    B_.col(3 + i).segment(k * n, n) = m.cwiseProduct(w.s.col(j));
  }
  for (Eigen::Index k = 0; k < n_s; ++k)
    for (int r = 0; r < 3; ++r)
      B_.col(6 + k).segment(r * n, n) = m.cwiseProduct(w.J.col(k).segment(r * n, n));
  if (stiffness_changes_) add_frame_columns(w, c);
  for (Eigen::Index k = 0; k < n_dense; ++k)
    B_.rightCols(n_dense).col(k) = c * std::sqrt(law_factor_) * dense[static_cast<std::size_t>(k)];
  T_ = B_;
  factor_->solve(T_.leftCols(n_r()));
  if (stiffness_changes_)
    factor_->solve(T_.middleCols(n_r() + 3, 3 + n_s));  // the first three columns of x_r are zero
  if (n_dense > 0) factor_->solve(T_.rightCols(n_dense));
  core_fixed_ = -B_.transpose() * T_;
  core_fixed_.diagonal().tail(n_dense).array() -= 1;
  if (part_->joint_points.empty()) return;
  B_Z_ = B_.transpose() * Z_;
  N_T_ = at_joints(T_);
}

/// Sets the columns M delta + Q of x_r in the border, and the blocks J_Q_, P_ and M_r_ of the core.
PLIANT_INLINE void ImplicitNodes::add_frame_columns(const NodalWorkspace& w, double c) {
  const Eigen::Index n = local().n_nodes(), n_d = local().n_d(), n_s = part_->n_s;
  const MatX<double> delta = implicit_nodes::turned_displacements(w, n_d);
  auto turned_columns = B_.middleCols(n_r() + 3, 3);
  turned_columns = local().inertia().asDiagonal() * delta;
  x_ = w.x;
  J_ = w.J;
  J_Q_.setZero(n_s, n_s);
  for (Eigen::Index k = 0; k < n_s; ++k) {
    VecX<double> J = VecX<double>::Zero(n_d);
    J.head(3 * n) = w.J.col(k);
    VecX<double> Q = law_factor_ * c * c * implicit_nodes::stiffness_along(local(), w.x, J);
    if (local().beta() > 0)
      Q += law_factor_ * c * local().beta() * implicit_nodes::viscosity_along(local(), w.x, J);
    J_Q_.col(k) = w.J.transpose() * Q.head(3 * n);
    B_.col(n_r() + 6 + k) = Q;
  }
  // H0 + delta^T W is the matrix H of include/pliant/part/local/README.md. The evaluation w contains the
  // factors of the matrix K = H - P^T in that file; P follows from H and K.
  const MatX<double> delta_W = delta.transpose() * B_.leftCols(n_r());
  MatX<double> H = w.H0;
  H.middleRows<3>(3) += delta_W;
  P_.setZero(n_r(), n_r());
  if (n_s > 0) {
    MatX<double> K = w.solve(MatX<double>(MatX<double>::Identity(n_r(), n_r())));  // K^-1 at first
    const VecX<double> scale = equalising_scales(K.diagonal());
    K = (scale.asDiagonal() * K * scale.asDiagonal()).eval().inverse().eval();
    P_.rightCols(n_s) = (H - scale.asDiagonal() * K * scale.asDiagonal()).transpose().rightCols(n_s);
    for (Eigen::Index k = 0; k < n_s; ++k)
      if (w.without_inertia.test(static_cast<std::size_t>(6 + k))) {
        P_.row(6 + k).setZero();
        P_.col(6 + k).setZero();
      }
  }
  M_r_ = H;
  M_r_.middleCols<3>(3) += delta_W.transpose();
  M_r_.block<3, 3>(3, 3) += delta.transpose() * turned_columns;
  M_r_ -= P_ + P_.transpose();
}

PLIANT_INLINE void ImplicitNodes::make_core(const LocalWorkspace& w) {
  MatX<double> core = core_fixed_;
  if (frame_in_border()) {
    const Part& part = *part_->part;
    const Eigen::Index n_s = part_->n_s;
    K_s_ = part.K_s();
    D_s_ = part.alpha() * w.H0.bottomRightCorner(n_s, n_s) + part.beta() * part.K_s();
    auto S_r = core.block(n_r(), n_r(), n_r(), n_r());
    S_r.bottomRightCorner(n_s, n_s) += c_ * D_s_ + c_ * c_ * K_s_;
    if (stiffness_changes_) {
      S_r += M_r_;
      S_r.bottomRightCorner(n_s, n_s) += J_Q_;
      core.block(0, n_r(), n_r(), n_r()) += P_;
      core.block(n_r(), 0, n_r(), n_r()) += P_.transpose();
    } else {
      S_r += w.H0;
    }
    for (int k = 0; k < n_s; ++k)
      if (w.without_inertia.test(
              static_cast<std::size_t>(6 + k))) {  // the column of W for this parameter is zero
        core(6 + k, 6 + k) -= 1;
        S_r(6 + k, 6 + k) += 1;
      }
  }
  core_scale_ = equalising_scales(core.diagonal());
  core_.compute(core_scale_.asDiagonal() * core * core_scale_.asDiagonal());
}

PLIANT_INLINE MatX<double> ImplicitNodes::at_joints(const MatX<double>& nodal) const {
  const auto n_p = 3 * static_cast<Eigen::Index>(part_->joint_points.size());
  MatX<double> values(n_p, nodal.cols());
  for (Eigen::Index k = 0; k < nodal.cols(); ++k)
    values.col(k) =
        at_points(part_->joint_points, Eigen::Map<const Nodes>(nodal.col(k).data(), local().n_nodes(), 3));
  return values;
}

/// Returns E of implicit_nodes.h for the rates r_q of the part's parameters and local coordinates.
PLIANT_INLINE VecX<double> ImplicitNodes::damping_excess(const VecX<double>& r_q_s,
                                                         const VecX<double>& r_q) const {
  const double beta = local().beta(), s = 1 / (beta + c_);
  VecX<double> rate = r_q;
  if (J_.cols() > 0) rate.head(J_.rows()) += J_ * r_q_s;
  return law_factor_ * c_ * beta * s *
         (implicit_nodes::viscosity_along(local(), x_, rate) -
          implicit_nodes::stiffness_along(local(), x_, rate));
}

PLIANT_INLINE void ImplicitNodes::filter(const VecX<double>& q_dot, const Mat3<double>& R,
                                         VecX<double>& v_dot) {
  const Eigen::Index n_s = part_->n_s, n_d = local().n_d();
  const VecX<double>& M = local().inertia();
  const auto r_q = q_dot.segment(part_->q0 + 7 + n_s, n_d);
  auto k_v = v_dot.segment(part_->v0 + 6 + n_s, n_d);
  // With s = 1 / (c + beta), e = r_v + s r_q and y = x_d + e, the first row of the system in implicit_nodes.h
  // is (S + c^2 w w^T) y + W kappa + (M delta + Q) x_r = M (e + s c alpha r_q) - Q e_s + E, without a product
  // with K.
  const double s = 1 / (local().beta() + c_);
  e_ = k_v + s * r_q;
  y_ = M.cwiseProduct(e_);
  if (local().alpha() > 0) y_ += s * c_ * local().alpha() * M.cwiseProduct(r_q);
  right_.setZero(B_.cols());
  if (frame_in_border()) {
    const VecX<double> r_v_s = v_dot.segment(part_->v0 + 6, n_s), r_q_s = q_dot.segment(part_->q0 + 7, n_s);
    auto right_s = right_.segment(n_r() + 6, n_s);
    right_s = -c_ * D_s_ * r_v_s - K_s_ * (c_ * c_ * r_v_s + c_ * r_q_s);
    if (stiffness_changes_) {
      const VecX<double> e_s = r_v_s + s * r_q_s;
      y_ -= B_.middleCols(n_r() + 6, n_s) * e_s;
      right_s -= J_Q_ * e_s;
      right_.segment<3>(n_r() + 3) = B_.middleCols(n_r() + 3, 3).transpose() * e_;
      if (local().beta() > 0) {
        const VecX<double> excess = damping_excess(r_q_s, r_q);
        y_ += excess;
        right_s += J_.transpose() * excess.head(J_.rows());
      }
    }
  }
  factor_->solve(y_);
  right_.head(n_r()) += B_.leftCols(n_r()).transpose() * e_;
  right_ -= B_.transpose() * y_;
  const VecX<double> z = solve_core(right_);
  y_ -= T_ * z;
  change_.setZero();
  if (frame_in_border()) {
    change_.head(n_r()) = z.segment(n_r(), n_r());
    v_dot.segment<3>(part_->v0) += R * change_.head<3>();
    v_dot.segment(part_->v0 + 3, n_r() - 3) += change_.segment(3, n_r() - 3);
  }
  e_ = y_ - e_;
  k_v += e_;
  if (!part_->joint_points.empty())
    change_.tail(change_.size() - n_r()) =
        at_points(part_->joint_points, Eigen::Map<const Nodes>(e_.data(), local().n_nodes(), 3));
}

PLIANT_INLINE MatX<double> ImplicitNodes::compliance() const {
  const auto n_p = static_cast<Eigen::Index>(change_.size()) - n_r();
  MatX<double> right = MatX<double>::Zero(B_.cols(), n_r() + n_p), A(n_r() + n_p, n_r() + n_p);
  if (frame_in_border()) right.block(n_r(), 0, n_r(), n_r()).setIdentity();
  if (n_p > 0) right.rightCols(n_p) -= B_Z_;
  const MatX<double> z = solve_core(right);
  if (frame_in_border()) {
    A.topRows(n_r()) = z.middleRows(n_r(), n_r());
  } else {
    A.topRows(n_r()).setZero();
    A.topLeftCorner(n_r(), n_r()) = H0_inverse_;
  }
  if (n_p > 0) {
    A.bottomRows(n_p) = -N_T_ * z;
    A.bottomRightCorner(n_p, n_p) += at_joints(Z_);
  }
  return 0.5 * (A + A.transpose());
}

PLIANT_INLINE void ImplicitNodes::push(const VecX<double>& g, Eigen::Ref<VecX<double>> d_ddot) const {
  const Eigen::Index n_p = g.size() - n_r();
  VecX<double> right = VecX<double>::Zero(B_.cols());
  if (frame_in_border()) right.segment(n_r(), n_r()) = g.head(n_r());
  if (n_p > 0) right -= B_Z_ * g.tail(n_p);
  d_ddot -= T_ * solve_core(right);
  if (n_p > 0) d_ddot += Z_ * g.tail(n_p);
}

PLIANT_INLINE void ImplicitNodes::respond(VecX<double>& on_frame, Eigen::Ref<VecX<double>> on_d) const {
  factor_->solve(on_d);
  VecX<double> right = -B_.transpose() * on_d;
  if (frame_in_border()) right.segment(n_r(), n_r()) += on_frame;
  const VecX<double> z = solve_core(right);
  on_d -= T_ * z;
  if (frame_in_border())
    on_frame = z.segment(n_r(), n_r());
  else
    on_frame = H0_inverse_ * on_frame;
}

}  // namespace pliant
