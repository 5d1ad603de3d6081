// A of a part that deforms locally, in (I - c A) k = r with c = gamma h (linearly_implicit.h): what is
// implicit of its elasticity and damping. One file a kind: implicit_nodes.h, implicit_modes.h.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

class ImplicitPart : public LocalResponse {
 public:
  /// Takes A at an evaluation of the part at time t. Returns the factorisations done. Throws
  /// NumericalFailure, OutOfMemory.
  virtual int prepare(const PartWorkspace<double>& w, double c, double t) = 0;
  /// v_dot <- k_v of the part, for rates r = (q_dot, v_dot) of all parts. R: of its frame.
  virtual void filter(const VecX<double>& q_dot, const Mat3<double>& R, VecX<double>& v_dot) = 0;
  /// x of the last filter() as a group knows the part (body/group.h): of v_r and of d_dot at its joints.
  const VecX<double>& change() const { return change_; }

 protected:
  explicit ImplicitPart(const PartModel& part) : part_(&part), change_(VecX<double>::Zero(part.n_x())) {}

  Eigen::Index n_r() const { return 6 + part_->n_s; }

  const PartModel* part_;
  VecX<double> change_;
};

}  // namespace pliant
