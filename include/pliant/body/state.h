// State: everything that is integrated, and every discrete mode. A step is a function of Model and State
// only, so a state can be copied, stored and resumed to the last bit.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <pliant/math/types.h>

namespace pliant {

/// Kinds of work in the energy ledger, J.
enum class Work {
  damping,
  drag,
  spring_damping,
  anchors,  ///< of hands that move the ends of springs and joints
  actuation,
  forces,
  limits,   ///< and of taut strings
  contact,  ///< of what pushes bodies apart
  friction,
  baumgarte,  ///< of joints that close
  projection  ///< of the impulses that close joints
};
inline constexpr int kWorks = 11;
inline constexpr std::array<const char*, kWorks> kWorkNames{
    "damping", "drag",    "spring_damping", "anchors",   "actuation", "forces",
    "limits",  "contact", "friction",       "baumgarte", "projection"};

/// What a joint does right now.
enum class JointMode : std::int8_t {
  off,      ///< nothing
  closing,  ///< it is open, and Baumgarte's equation closes it
  closed,   ///< it holds
  slack     ///< one-sided, and open: it does nothing
};

/// A contact that shares what it pushes with others, and the force that it took: where the search for its
/// impulse of the next step begins. Rows of limits and strings, and what shares lone nodes, begin at none.
struct CachedContact {
  std::array<int, 4> between;  ///< part a, part b, plane, obstacle; -1: none
  Vec3<double> x;              ///< where it was, m, in the frame of part a
  /// Mean of the last step or, where it was taken in two, its second half; on part a, N, world.
  Vec3<double> force;
};

struct State {
  double start = 0;       ///< time of step 0, s
  double h = 0;           ///< step, s; where errors are controlled, the next one
  std::int64_t step = 0;  ///< steps done since start; time is start + step * h
  double error = 0;       ///< of the last step, in tolerances; 0 where it is not measured
  /// What the impulses at contacts missed of their laws in the last step, at the worst of them, m/s.
  double contact_residual = 0;
  VecX<double> q;  ///< per part: c (3), quaternion w x y z (4), q_s
  VecX<double> v;  ///< per part: c_dot (world, 3), omega (body, 3), q_s_dot
  Vec<double, kWorks> work = Vec<double, kWorks>::Zero();  ///< done so far
  std::vector<std::int8_t>
      at_limit;                   ///< per dynamic parameter: -1 at its lower limit, 1 at its upper, 0 free
  std::vector<JointMode> joints;  ///< of each joint
  /// Per part, where bodies may sleep (else empty): how long it has been at rest, s; negative: it sleeps,
  /// with those of the same number. Who moves a part that sleeps wakes it.
  std::vector<double> at_rest;
  std::vector<CachedContact> contact_cache;  ///< in the order of what they are between
  /// How many steps in a row have begun at those before: after some of them one begins anew, so that forces
  /// which nothing calls for any more, as in a body between two walls, do not stay.
  int contact_cache_age = 0;

  double time() const { return start + static_cast<double>(step) * h; }
};

/// Whether a part sleeps: it stays as it is, to the last bit, and rests.
inline bool sleeps(const State& state, int part) {
  return !state.at_rest.empty() && state.at_rest[static_cast<std::size_t>(part)] < 0;
}

/// Whether the same parts sleep, of State::at_rest of two states.
bool same_sleepers(const std::vector<double>& one, const std::vector<double>& other);

/// Wakes a part, and all that fell asleep with it.
void wake(State& state, int part);

/// Of all bits of a state.
std::uint64_t hash(const State& state);

}  // namespace pliant
