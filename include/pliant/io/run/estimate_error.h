// How wrong a run is: it is run again, to a tenth of its tolerance, with half the steps where bodies lie on
// each other, or with half its step, and compared at every recorded time.
#pragma once

#include <string>

#include <pliant/io/recording.h>
#include <pliant/io/run/progress.h>
#include <pliant/scene/scene.h>

namespace pliant {

/// The largest differences over all parts and recorded times; rates likewise.
struct ErrorEstimate {
  double place = 0;                ///< of frames, m
  double rotation = 0;             ///< rad
  double length = 0;               ///< of parameters that are lengths, m
  double parameter = 0;            ///< of all others
  double displacement = 0;         ///< local, of coordinates of nodes or modes, in their unit
  double velocity = 0;             ///< of frames, m/s
  double angular_velocity = 0;     ///< rad/s
  double energy = 0;               ///< kinetic and potential, J
  double joint_force = 0;          ///< on the parts of joints, N
  double joint_torque = 0;         ///< N m
  double gap = 0;                  ///< of joints of the run that hold, m
  double tolerance = 0, step = 0;  ///< of the run that it was compared with; one of them is 0
};

/// Throws std::invalid_argument of a scene whose tolerance is the least that there is.
void require_better_run(const Scene& scene);

/// integrator: name of the method of the run. Throws what steps of a simulation throw, RecordingMismatch, and
/// as require_better_run() does.
ErrorEstimate estimate_error(Scene& scene, const std::string& integrator, double step, const Recording& run,
                             int threads, Progress& progress);

}  // namespace pliant
