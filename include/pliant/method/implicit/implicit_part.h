// The block of the matrix A for one part that deforms locally, in (I - c A) k = r with c = gamma h
// (linearly_implicit.h): the elasticity and damping of the part. Such a part is called implicit, all others
// explicit. To filter the rates r means to solve this equation for k. implicit_nodes.h and implicit_modes.h
// contain the two kinds of implicit parts.
#pragma once

#include <memory>
#include <vector>

#include <pliant/body/dynamics.h>

namespace pliant {

class ImplicitPart : public LocalResponse {
 public:
  /// Prepares the filter for c (s). w: an evaluation of the part at time t (s). Returns the number of
  /// factorisations. Throws NumericalFailure or OutOfMemory if the stiffness cannot be factored.
  virtual int prepare(const PartWorkspace<double>& w, double c, double t) = 0;
  /// Replaces the entries of this part in v_dot by k_v. q_dot, v_dot: the rates r = (r_q, r_v) of all parts.
  /// R: orientation of the frame of this part, body to world.
  virtual void filter(const VecX<double>& q_dot, const Mat3<double>& R, VecX<double>& v_dot) = 0;
  /// Returns the change x = k_v - r_v by the last filter(): the changes of the rates of v_r = (R^T c_dot,
  /// omega, q_s_dot), 6 + n_s numbers, and then of d_dot at the attachment points of joints, three numbers
  /// each (body/constraint/group.h).
  const VecX<double>& change() const { return change_; }

 protected:
  explicit ImplicitPart(const PartModel& part) : part_(&part), change_(VecX<double>::Zero(part.n_x())) {}

  /// Number of entries of v_r.
  Eigen::Index n_r() const { return 6 + part_->n_s; }

  const PartModel* part_;
  VecX<double> change_;
};

/// One entry for each part of a model; nullptr for an explicit part.
using ImplicitParts = std::vector<std::unique_ptr<ImplicitPart>>;

}  // namespace pliant
