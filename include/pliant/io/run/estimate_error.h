// The error estimate of a run. The run is repeated with a tenth of its tolerance (at least kMinTolerance) and
// half the longest contact step (contact/longest_contact_step.h), or with half its fixed step. The two runs
// are compared at every recorded time.
#pragma once

#include <string>

#include <pliant/io/recording.h>
#include <pliant/io/run/progress.h>
#include <pliant/scene/scene.h>

namespace pliant {

/// The largest absolute differences between a run and its repetition, over all parts and recorded times.
struct ErrorEstimate {
  double place = 0;                ///< position of the frames of parts, m
  double rotation = 0;             ///< rotation of the frames, rad
  double length = 0;               ///< parameters that are lengths, m
  double parameter = 0;            ///< other parameters, rad or 1
  double displacement = 0;         ///< local coordinates (nodes, polynomials or modes), in their unit
  double velocity = 0;             ///< velocity of the frames, m/s
  double angular_velocity = 0;     ///< angular velocity of the frames, rad/s
  double energy = 0;               ///< total energy, J
  double joint_force = 0;          ///< force of a joint that has the same JointMode in both runs, N
  double joint_torque = 0;         ///< torque of a joint that has the same JointMode in both runs, N m
  double gap = 0;                  ///< largest gap of a closed joint of the run, m (not a difference)
  double tolerance = 0, step = 0;  ///< tolerance and fixed step (s) of the repetition; one of them is 0
};

/// Throws std::invalid_argument if the scene has the smallest possible tolerance, so that no more accurate
/// run exists.
void require_better_run(const Scene& scene);

/// Repeats a run more accurately and returns the differences. integrator: name of the method of the run;
/// step: fixed step of the run, s, or 0 with a tolerance; run: recording of the run. threads: number of
/// threads. Throws what Simulation::step() and require_better_run() throw, and RecordingMismatch.
ErrorEstimate estimate_error(Scene& scene, const std::string& integrator, double step, const Recording& run,
                             int threads, Progress& progress);

}  // namespace pliant
