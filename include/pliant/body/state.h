// State: all quantities that are integrated, and every discrete mode (of limits, joints and sleep). A step is
// a function of Model and State only. A state can be copied, stored and resumed to the last bit.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <pliant/math/types.h>

namespace pliant {

/// Kinds of work in the energy ledger, J.
enum class Work {
  damping,         ///< D of the global parameters, and damping of local deformation
  drag,            ///< drag nu M v
  spring_damping,  ///< dampers of springs, and of drives whose energy is in the ledger
  anchors,         ///< prescribed motion of ends of springs, joints and drives
  actuation,       ///< drives, muscles; changes of rest values, gravity, local stiffness
  forces,          ///< forces at points, distributed forces and torques
  limits,          ///< limits of parameters and joints, and taut strings
  contact,         ///< normal impulses of contacts, and separation of overlapping parts
  friction,        ///< friction at contacts
  baumgarte,       ///< Baumgarte's terms of closing joints, and of closed joints that are not projected
  projection       ///< projection of joints
};
inline constexpr int kWorks = 11;
inline constexpr std::array<const char*, kWorks> kWorkNames{
    "damping", "drag",    "spring_damping", "anchors",   "actuation", "forces",
    "limits",  "contact", "friction",       "baumgarte", "projection"};

/// The mode of a joint.
enum class JointMode : std::int8_t {
  off,      ///< outside its times on ... off: no force
  closing,  ///< open: Baumgarte's equation closes the joint
  closed,   ///< C = 0; for a one-sided joint: a taut string, or a coordinate at its limit
  slack     ///< only for one-sided joints: C > 0, or C_dot > 0 at C = 0; no force
};

/// A contact of the last step. Its force gives the start value of the contact impulse in the next step (warm
/// start), and predicts this impulse if the step predicts impulses (contact/predicted_impulses.h). Contacts
/// without impulse are not stored. Without predictions, contacts that share no moving part with other
/// contacts are not stored. Contacts on single nodes of a mesh, and contacts that moving parts connect with
/// contacts on nodes, are not stored: their impulses start at zero. The impulses of limits and strings start
/// at zero too.
struct CachedContact {
  std::array<int, 4> between;  ///< numbers of part a, part b, plane, obstacle; -1: none
  Vec3<double> x;              ///< position of the contact, m, frame of part a
  /// Mean force on part a, N, world, in the last step. If the step was repeated in halves or thirds
  /// (contact/step_doubling-inl.h): in the last half or third.
  Vec3<double> force;
  /// Whether this force acted during the whole step: the contact rested, and no impact happened at the bodies
  /// that contacts connect with this contact.
  bool lasting = false;
};

/// Step length and other results of the last step of a part, if parts step in clusters
/// (simulate/clusters.h). The next step of the part uses these results. The parts of a cluster have equal
/// values after a step.
struct StepMemory {
  double h = 0;                 ///< length of the next step, s; 0 before the first step
  double error = 0;             ///< State::error of the last step of the part's cluster
  double contact_residual = 0;  ///< State::contact_residual of the last step, m/s
  int contact_cache_age = 0;    ///< State::contact_cache_age
};

struct State {
  double start = 0;       ///< time of step 0, s
  double h = 0;           ///< step length, s; if errors are controlled, the length of the next step
  std::int64_t step = 0;  ///< number of steps since start; time is start + step * h
  double error = 0;       ///< error of the last step divided by the tolerance; 0 if no error is measured
  /// Largest violation of the contact laws by the impulses of the last step, m/s.
  double contact_residual = 0;
  VecX<double> q;  ///< coordinates of all parts: c (3), quaternion w x y z (4), q_s, q_d of each
  VecX<double> v;  ///< velocities of all parts: c_dot (world, 3), omega (body, 3), q_s_dot, q_d_dot of each
  Vec<double, kWorks> work = Vec<double, kWorks>::Zero();  ///< work since start, J
  VecX<double> inputs;  ///< values that a controller sets, constant in a step (MultiBody::input)
  /// Of each dynamic parameter: -1 at its lower limit, 1 at its upper limit, 0 between.
  std::vector<std::int8_t> at_limit;
  std::vector<JointMode> joints;  ///< mode of each joint
  /// Of each part: time at rest, s. A negative number means that the part sleeps; parts with equal negative
  /// numbers fell asleep together. Empty if parts cannot sleep. Code that moves a sleeping part must wake it.
  std::vector<double> at_rest;
  std::vector<CachedContact> contact_cache;  ///< sorted by `between`
  /// Number of successive steps with a warm start. After a fixed number, the contact solver starts from zero
  /// impulses, so that forces without a cause, for instance of a part wedged between two walls, do not
  /// persist.
  int contact_cache_age = 0;
  /// Of each part, if the parts step in clusters; else empty. If parts step in clusters, h of this state is
  /// the length of an interval of the clusters; error, contact_residual and contact_cache_age are the largest
  /// values of all parts.
  std::vector<StepMemory> step_memory;

  double time() const { return start + static_cast<double>(step) * h; }
};

/// Whether a part sleeps. A sleeping part is at rest, and its coordinates keep all their bits.
inline bool sleeps(const State& state, int part) {
  return !state.at_rest.empty() && state.at_rest[static_cast<std::size_t>(part)] < 0;
}

/// Whether two states have equal sets of sleeping parts; arguments: their State::at_rest.
bool same_sleepers(const std::vector<double>& one, const std::vector<double>& other);

/// Wakes a part and all parts that fell asleep with it. Does nothing if the part is awake.
void wake(State& state, int part);

/// Returns a hash of all bits of a state.
std::uint64_t hash(const State& state);

}  // namespace pliant
