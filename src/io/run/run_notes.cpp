// The notes of a run for its user: about the setup, the motion and the accuracy.
#include <pliant/io/run/run.h>

#include <algorithm>
#include <utility>

#include <pliant/contact/longest_contact_step.h>
#include <pliant/io/format/number_text.h>
#include <pliant/io/run/contact_notes.h>
#include <pliant/io/run/energy_gate.h>
#include <pliant/io/run/joint_notes.h>
#include <pliant/io/run/slow_note.h>
#include <pliant/part/mesh/surface_turn.h>

namespace pliant {
namespace {

/// Words of the notes on steps without error control and on open joints, by which they are found again.
constexpr const char* kUncontrolledText = "resting contacts of many bodies, or of soft bodies, in ";
constexpr const char* kOpenJointsText = " still open: ";

}  // namespace

/// Adds notes on a step that is too large, on the chosen integrator, on the assembly and on redundant
/// constraints.
void Run::note_setup(const StableStep& stable) {
  if (scene_->tolerance == 0 && schedule_.step() > stable.step) {
    note("warning: the step of " + number_text(schedule_.step()) +
         " s is larger than the largest stable step, about " + rounded_text(stable.step) + " s, limited by " +
         stable.limit + "; choose a smaller step");
  }
  if (scene_->tolerance == 0 && !stable.uncounted.empty())
    note("the largest stable step is not certain: " + stable.uncounted);
  if (!simulation_->choice().integrator.empty())
    note("integrator " + simulation_->choice().integrator + ": " + simulation_->choice().why);
  const AssemblyReport& assembly = simulation_->assembly();
  if (assembly.iterations > 0)
    note("assembled before time 0: gaps of up to " + rounded_text(assembly.gap_before) + " m closed in " +
         count_text(assembly.iterations, "iteration") +
         (assembly.converged ? "" : ", the maximum; the shapes have not converged"));
  note_redundancy();
}

void Run::note(const std::string& text) {
  if (std::find(record_.notes.begin(), record_.notes.end(), text) == record_.notes.end())
    record_.notes.push_back(text);
  progress_->note(text);
}

void Run::note_once(const std::string& text) {
  if (std::find(record_.notes.begin(), record_.notes.end(), text) == record_.notes.end()) note(text);
}

/// Adds notes on redundant constraints, if the set of acting joints has changed since the last call; each
/// text at most once.
void Run::note_redundancy() {
  std::vector<bool> acting;
  for (const JointMode mode : simulation_->state().joints) acting.push_back(mode != JointMode::off);
  if (acting == reported_acting_) return;
  reported_acting_ = std::move(acting);
  for (const std::string& text : redundancy_notes(*simulation_))
    if (reported_redundant_.insert(text).second) note_once(text);
}

void Run::note_engagements() {
  for (const std::string& text : engage_notes(*simulation_, reported_impulses_, record_.notes))
    note_once(text);
  reported_impulses_ = simulation_->engage_impulses().size();
}

/// Adds a note, once per part, if the parameters of the part rotate its surface so far that elasticity linear
/// in d is no longer accurate.
void Run::note_turns() {
  for (const PartModel& m : simulation_->model().parts()) {
    if (m.q0 < 0 || !linear_on_moving_shape(*m.part) || reported_turned_.count(m.part->name()) > 0) continue;
    const double turn = largest_surface_turn(*m.part, simulation_->state().q.segment(m.q0 + 7, m.n_s));
    if (!(turn > kMaxLinearRotation)) continue;
    reported_turned_.insert(m.part->name());
    note_once("warning: at t = " + rounded_text(simulation_->time()) + " s the parameters of part '" +
              m.part->name() + "' rotate some of its surface by " + rounded_text(turn) +
              " rad; a local law that is linear in the displacements is accurate up to about " +
              rounded_text(kMaxLinearRotation) +
              " rad; use a law that is valid for all rotations (neo_hookean, st_venant_kirchhoff, corotated, "
              "neo_hookean_membrane, st_venant_kirchhoff_membrane)");
  }
}

/// Adds a note, once, if the simulation has hardly advanced.
void Run::note_slow_progress() {
  if (!simulation_->slow_progress()) return;
  const std::vector<std::string>& notes = record_.notes;
  if (std::none_of(notes.begin(), notes.end(), is_slow_progress_note)) note(slow_progress_note(*simulation_));
}

/// Adds a note, once, if a visible part is below the drawn ground.
void Run::note_ground() {
  if (reported_ground_ || !scene_->ground.visible || !scene_->ground.height) return;
  const std::vector<PartModel>& parts = simulation_->model().parts();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const PartModel& m = parts[i];
    if (m.q0 < 0 || !scene_->appearance[i].visible) continue;
    if (!(simulation_->state().q[m.q0 + 2] < *scene_->ground.height - m.size)) continue;
    reported_ground_ = true;
    note_once("at t = " + rounded_text(simulation_->time()) + " s part '" + m.part->name() +
              "' is below the drawn ground, which is not solid; add a plane at its height, " +
              rounded_text(*scene_->ground.height) + " m, to \"contact\"");
    return;
  }
}

/// Adds notes on violations of the laws of contact. These notes replace the notes of earlier sessions of a
/// resumed run. update_record() must have updated the counters.
void Run::note_violations() {
  replace_notes(is_violation_note, violation_notes(record_.work.steps, scene_->body.contact));
}

/// Adds a note on the largest error of the energy balance, in place of the note of earlier sessions.
void Run::note_energy_balance() {
  const std::string text = energy_note(*simulation_, *energies_);
  replace_notes(is_energy_note, text.empty() ? std::vector<std::string>() : std::vector<std::string>{text});
}

/// Adds a note on the steps whose error is not controlled, in place of the note of earlier sessions.
/// update_record() must have updated the counters.
void Run::note_uncontrolled_steps() {
  std::vector<std::string> notes;
  if (record_.work.steps.uncontrolled > 0)
    notes.push_back(kUncontrolledText + count_text(record_.work.steps.uncontrolled, "step") +
                    ": the error of these steps is not controlled; they are at most " +
                    rounded_text(longest_contact_step(scene_->body.contact, simulation_->tolerance())) +
                    " s long, and --estimate-error measures their error");
  replace_notes([](const std::string& note) { return note.rfind(kUncontrolledText, 0) == 0; }, notes);
}

/// Adds a note on the joints that are open at the end, in place of the note of earlier sessions.
void Run::note_open_joints() {
  const std::string text = open_joints_note(*simulation_);
  replace_notes([](const std::string& note) { return note.find(kOpenJointsText) != std::string::npos; },
                text.empty() ? std::vector<std::string>() : std::vector<std::string>{text});
}

/// Replaces the notes for which is_old() is true by `notes`.
void Run::replace_notes(bool (*is_old)(const std::string&), const std::vector<std::string>& notes) {
  record_.notes.erase(std::remove_if(record_.notes.begin(), record_.notes.end(), is_old),
                      record_.notes.end());
  for (const std::string& text : notes) note(text);
}

}  // namespace pliant
