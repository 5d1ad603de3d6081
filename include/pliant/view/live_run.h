// A LiveSimulation in its own thread. The thread of the window sends commands and reads snapshots; only
// wait_for() waits for a step.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <pliant/view/forces.h>
#include <pliant/view/live_simulation.h>

namespace pliant {

/// The data of a running simulation that the window shows.
struct Snapshot {
  State state;
  Ledger ledger;             ///< of `state`, or of a state up to 0.1 s of wall time older
  double speed = 0;          ///< simulated time / wall time in the last half second; 0 while paused
  double interval_cost = 0;  ///< wall time to compute an interval, s
  double delay = 0;          ///< wall time by which the simulation is late, s; 0 if paused or unlimited
  bool running = false;
  bool dragging = false;
  Vec3<double> held = Vec3<double>::Zero();    ///< position of the dragged point, m
  Vec3<double> target = Vec3<double>::Zero();  ///< position of the moving point of the world, m
  ForceArrows forces;                          ///< of the kinds that are shown
  std::string failure;  ///< message of the step that failed; only a reset continues. Empty without a failure
  std::string refusal;  ///< message of the last command, if it failed
  std::string report;   ///< text of the last command of post_report()
};

/// The positions of the tracked points at the end of an interval.
struct TrackSample {
  double time;                       ///< s
  std::vector<Vec3<double>> points;  ///< in the order of Scene::tracks, m, world
};

class LiveRun {
 public:
  /// Prepares the simulation on the calling thread (LiveSimulation), and starts the thread, paused at time 0.
  explicit LiveRun(Scene& scene, double display_rate = 60, int threads = 1);
  ~LiveRun();
  LiveRun(const LiveRun&) = delete;
  LiveRun& operator=(const LiveRun&) = delete;

  using Command = std::function<void(LiveSimulation&)>;
  /// Performs a command on the thread of the simulation before its next interval. If the command throws, the
  /// next snapshot has the message.
  void post(Command command);
  /// Performs a command on the thread of the simulation before its next interval, or before the object is
  /// destroyed. Later snapshots have the text that the command returns, or the message if the command throws.
  void post_report(std::function<std::string(LiveSimulation&)> command);
  void play();
  void pause();
  /// Advances by one interval, then pauses.
  void step_once();
  /// Returns to time 0, paused.
  void reset();
  /// Sets the largest speed, simulated time / wall time; infinity: as fast as possible.
  void set_max_speed(double speed);

  /// Chooses the forces of later snapshots.
  void show_forces(const ShownForces& shown);

  /// Returns the last snapshot. A snapshot never changes; each later state has a new one.
  std::shared_ptr<const Snapshot> snapshot() const;
  /// Returns the samples of the tracks at time 0 and at the ends of all intervals since the last call, in
  /// their order. After a reset, the time of the next sample is not later than the time of the last sample
  /// before the reset.
  std::vector<TrackSample> take_track_samples();
  /// Performs a command before the next interval and waits for it. Throws what the command throws.
  void wait_for(Command command);

 private:
  void loop();
  bool wait_for_work(std::vector<Command>& commands);
  void perform(std::vector<Command>& commands);
  void advance();
  void publish();
  void sample_tracks();
  void keep_pace();

  LiveSimulation simulation_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_:
  std::vector<Command> commands_;
  std::shared_ptr<const Snapshot> snapshot_;
  std::vector<TrackSample> track_samples_;
  bool running_ = false, quits_ = false;
  int single_steps_ = 0;
  double max_speed_ = 1;
  // Used by the thread of the simulation only:
  class Clock;
  std::unique_ptr<Clock> clock_;
  std::string failure_, refusal_, report_;
  double sampled_time_ = -1;  // of the last sample of the tracks, s
  Ledger ledger_;
  ShownForces shown_;
  std::thread thread_;
};

}  // namespace pliant
