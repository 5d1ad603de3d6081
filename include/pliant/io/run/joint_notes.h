// Notes about joints: redundant constraints, open joints, impulses of engaging joints.
#pragma once

#include <string>
#include <vector>

#include <pliant/simulate/simulation.h>

namespace pliant {

/// Returns notes on the constraint rows at the state of the simulation that are redundant, that contradict
/// other rows, or whose row of C_q is zero (no direction); empty if there are no such rows. Redundant rows do
/// not change the motion; the constraint forces are computed without them.
std::vector<std::string> redundancy_notes(const Simulation& simulation);

/// Returns a note with the number of open joints and the widest gap, or an empty text if all joints are
/// closed.
std::string open_joints_note(const Simulation& simulation);

/// Returns notes on the impulses of simulation.engage_impulses() from index `first` on. For each time at
/// which joints engage, a note gives the largest impulse. For each time at which the velocities of prescribed
/// paths jump, a note gives the largest impulse, unless a note in `earlier` reports the path of this joint.
std::vector<std::string> engage_notes(const Simulation& simulation, std::size_t first,
                                      const std::vector<std::string>& earlier);

/// Returns the solvers of the joints: "blocks", "augmented", "blocks and augmented", or an empty text.
std::string solver_note(const Model& model);

/// Widest gaps of the closed and of the open joints at the state of a simulation, m; 0 if there is no such
/// joint. Joints that are off and slack strings are in neither group. A joint is closed if its mode is
/// JointMode::closed. Without projection, a joint whose gap is at most kClosedGap (project/project.h) times
/// the size of its smaller part is closed too.
struct Gaps {
  double closed = 0, open = 0;
};
Gaps widest_gaps(const Simulation& simulation);

}  // namespace pliant
