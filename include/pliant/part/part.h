// A part: a solid primitive with its global deformations, its mass and its elasticity. Part is the class that
// users see; the class does not depend on the type of the shape. Its code is in four files:
//   part_description.h   the settings of the user: place, velocity, rest, stiffness, damping, mass, ...
//   part_constants.h     the results of prepare(): mass points, K_s, inertia at rest, ...
//   part_evaluation.h    the evaluation in a step: s, J, normals, M and g_q
//   primitive.h          Primitive<Shape, GlobalDeform>, the concrete part, which adds the kernels
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pliant/part/mesh/triangle_mesh.h>
#include <pliant/part/part_evaluation.h>

namespace pliant {

class Part : public PartEvaluation {
 public:
  /// Computes the constants of the part. Returns at once if nothing has changed since the last call. Throws
  /// std::invalid_argument if the description contradicts itself, if the part folds over at its rest or
  /// initial values, or if its mass points, its elasticity or its local deformation cannot be made.
  void prepare();
  /// Computes the constants as prepare() does, and shares them with all parts of equal description that were
  /// prepared with this cache. Shared constants equal those of prepare() to the last bit.
  /// MultiBody::prepare() uses the cache of a body.
  void prepare(ConstantsCache& known);
  bool prepared() const { return !changed(); }

  // The functions below are valid after prepare().

  /// The results of prepare(). Parts that share constants return the same object.
  const PartConstants& constants() const { return *constants_; }

  /// Number of local coordinates; 0 if the part does not deform locally.
  int n_d() const { return constants_->local ? static_cast<int>(constants_->local->n_d()) : 0; }
  /// Number of velocities: linear, angular, dynamic parameters, local coordinates; 0 for a fixed part.
  int n_v() const { return fixed() ? 0 : 6 + n_s() + n_d(); }
  /// Number of coordinates: position, quaternion, dynamic parameters, local coordinates; 0 for a fixed part.
  int n_q() const { return fixed() ? 0 : 7 + n_s() + n_d(); }

  const MassPoints& mass_points() const { return constants_->mass_points; }
  double total_mass() const { return constants_->rest_inertia.mass; }
  /// The inertia at rest. A rigid part has this inertia at all times.
  const Inertia<double>& rest_inertia() const { return constants_->rest_inertia; }
  /// The largest absolute coordinate of the surface at rest in the body frame, m, from a sample of its
  /// points.
  double size() const { return constants_->size; }
  /// Returns the smallest inertia of the k-th dynamic parameter (kg for a length, else kg m^2) that is not a
  /// rounding error for a part of this mass and size. A diagonal entry of M up to this value is treated as
  /// zero.
  double inertia_floor(int k) const;

  /// The stiffness K_s over the dynamic parameters.
  const MatX<double>& K_s() const { return constants_->K_s; }
  /// The strain energy of the elastic material; nullptr if the part has no elastic material or no dynamic
  /// parameter.
  const ContinuumEnergy* continuum() const { return constants_->continuum.get(); }
  /// Returns d2E/dq_s2 at q_s (n_s x n_s). E is the sum of the energies of K_s and of the elastic material.
  MatX<double> elastic_stiffness(const VecMax<double>& q_s) const;
  /// Returns the matrix that beta multiplies in the damping of q_s (n_s x n_s): K_s, plus
  /// ContinuumEnergy::strain_stiffness() if the part has elastic material. The matrix is positive
  /// semidefinite.
  MatX<double> strain_stiffness(const VecMax<double>& q_s) const;
  /// The local deformation; nullptr if the part does not deform locally.
  const LocalDeformation* local() const { return constants_->local.get(); }

 protected:
  using PartEvaluation::PartEvaluation;

 private:
  void compute_constants();
  // The steps of compute_constants(), in order. out: the object that constants() returns.
  void compute_size(PartConstants& out) const;
  void use_given_inertia(PartConstants& out) const;
  /// Computes the mass points and the inertia at rest. Returns the volume of a solid (m^3) or the area of a
  /// shell (m^2) for elastic material. With a mass distribution the volume needs a second search; a part
  /// without elastic material skips this search, and the result is then not the volume.
  double compute_inertia(PartConstants& out) const;
  void compute_elasticity(double volume, PartConstants& out) const;
};

}  // namespace pliant
