// The part of the matrix A that belongs to one part that deforms locally, in (I - c A) k = r with c = gamma h
// (linearly_implicit.h): its implicit elasticity and damping. implicit_nodes.h and implicit_modes.h are the
// two kinds.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

class ImplicitPart : public LocalResponse {
 public:
  /// Prepares A at an evaluation of the part at time t, s. Returns the number of factorisations. Throws
  /// NumericalFailure, OutOfMemory.
  virtual int prepare(const PartWorkspace<double>& w, double c, double t) = 0;
  /// Replaces v_dot of the part by k_v, for the rates r = (q_dot, v_dot) of all parts. R: orientation of its
  /// frame.
  virtual void filter(const VecX<double>& q_dot, const Mat3<double>& R, VecX<double>& v_dot) = 0;
  /// Returns x of the last filter() for v_r and for d_dot at the joints (body/constraint/group.h).
  const VecX<double>& change() const { return change_; }

 protected:
  explicit ImplicitPart(const PartModel& part) : part_(&part), change_(VecX<double>::Zero(part.n_x())) {}

  Eigen::Index n_r() const { return 6 + part_->n_s; }

  const PartModel* part_;
  VecX<double> change_;
};

}  // namespace pliant
