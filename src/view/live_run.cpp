// The thread of a simulation: commands, one interval, a snapshot, and a pause until the wall time of the next
// interval.
#include <pliant/view/live_run.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <limits>
#include <utility>

#include <pliant/body/placed_point.h>
#include <pliant/io/run/wall_clock.h>

namespace pliant {
namespace {

/// Time over which the speed is measured, time before the first measured speed, and time between two ledgers,
/// s of wall time.
constexpr double kSpeedWindow = 0.5, kFirstSpeed = 0.1, kLedgerEvery = 0.1;
/// Largest delay of the simulation that is caught up, s of wall time. In a scene that just reaches real time,
/// impacts delay the simulation by half a second.
constexpr double kMaxDelay = 1;

}  // namespace

/// The wall times of the thread.
class LiveRun::Clock {
 public:
  /// Starts again: the next interval is due now.
  void restart(double time) {
    due_ = measured_ = WallClock::now();
    measured_time_ = time;
    speed_ = delay_ = 0;
  }
  /// Returns the wall time at which the next interval is due. interval: length of an interval, s. max_speed:
  /// largest simulated time / wall time.
  WallClock::time_point next_due(double interval, double max_speed) {
    const WallClock::time_point now = WallClock::now();
    if (!std::isfinite(max_speed)) {
      delay_ = 0;
      return due_ = now;
    }
    due_ +=
        std::chrono::duration_cast<WallClock::duration>(std::chrono::duration<double>(interval / max_speed));
    const auto latest =
        std::chrono::duration_cast<WallClock::duration>(std::chrono::duration<double>(kMaxDelay));
    due_ = std::max(due_, now - latest);
    delay_ = std::max(0.0, std::chrono::duration<double>(now - due_).count());
    return due_;
  }
  /// Returns how late the last interval ended, s.
  double delay() const { return delay_; }
  /// Moves the due time by the time that commands took, so that this time is not caught up. start: wall time
  /// at which the commands began.
  void skip_since(WallClock::time_point start) { due_ += WallClock::now() - start; }
  /// Measures the speed at a simulated time, s. Returns 0 until kFirstSpeed seconds have passed.
  double speed(double time) {
    const double wall = seconds_since(measured_);
    if (wall >= kSpeedWindow || (speed_ == 0 && wall >= kFirstSpeed)) {
      speed_ = (time - measured_time_) / wall;
      if (wall >= kSpeedWindow) {
        measured_ = WallClock::now();
        measured_time_ = time;
      }
    }
    return speed_;
  }
  bool ledger_is_old() const { return seconds_since(ledger_) >= kLedgerEvery; }
  void note_ledger() { ledger_ = WallClock::now(); }
  double interval_cost = 0;  ///< wall time of the last interval, s

 private:
  WallClock::time_point due_ = WallClock::now(), measured_ = due_, ledger_ = due_;
  double measured_time_ = 0, speed_ = 0, delay_ = 0;
};

LiveRun::LiveRun(Scene& scene, double display_rate, int threads)
    : simulation_(scene, display_rate, threads), clock_(std::make_unique<Clock>()) {
  ledger_ = simulation_.ledger();
  publish();
  thread_ = std::thread([this] { loop(); });
}

LiveRun::~LiveRun() {
  {
    const std::lock_guard lock(mutex_);
    quits_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void LiveRun::post(Command command) {
  {
    const std::lock_guard lock(mutex_);
    commands_.push_back(std::move(command));
  }
  changed_.notify_all();
}

void LiveRun::post_report(std::function<std::string(LiveSimulation&)> command) {
  post([this, command = std::move(command)](LiveSimulation& simulation) {
    try {
      report_ = command(simulation);
    } catch (const std::exception& failure) {
      report_ = failure.what();
    }
  });
}

void LiveRun::wait_for(Command command) {
  std::packaged_task<void(LiveSimulation&)> task(std::move(command));
  std::future<void> done = task.get_future();
  post([&task](LiveSimulation& simulation) { task(simulation); });
  done.get();
}

void LiveRun::play() {
  {
    const std::lock_guard lock(mutex_);
    running_ = true;
  }
  post([this](LiveSimulation& simulation) { clock_->restart(simulation.simulation().time()); });
}

void LiveRun::pause() {
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
    single_steps_ = 0;
  }
  post([](LiveSimulation&) {});
}

void LiveRun::step_once() {
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
    ++single_steps_;
  }
  changed_.notify_all();
}

void LiveRun::reset() {
  pause();
  post([this](LiveSimulation& simulation) {
    failure_.clear();
    report_.clear();
    simulation.reset();
    ledger_ = simulation.ledger();
  });
}

void LiveRun::set_max_speed(double speed) {
  {
    const std::lock_guard lock(mutex_);
    max_speed_ = speed;
  }
  post([this](LiveSimulation& simulation) { clock_->restart(simulation.simulation().time()); });
}

void LiveRun::show_forces(const ShownForces& shown) {
  post([this, shown](LiveSimulation&) { shown_ = shown; });
}

std::shared_ptr<const Snapshot> LiveRun::snapshot() const {
  const std::lock_guard lock(mutex_);
  return snapshot_;
}

std::vector<TrackSample> LiveRun::take_track_samples() {
  const std::lock_guard lock(mutex_);
  return std::exchange(track_samples_, {});
}

/// Samples the tracks, unless they were already sampled at this time.
void LiveRun::sample_tracks() {
  const Simulation& simulation = simulation_.simulation();
  if (simulation_.scene().tracks.empty() || simulation.time() == sampled_time_) return;
  TrackSample sample{sampled_time_ = simulation.time(), {}};
  for (const Track& track : simulation_.scene().tracks)
    sample.points.push_back(PlacedPoint(simulation.model(), track.point).at(simulation.state()));
  const std::lock_guard lock(mutex_);
  track_samples_.push_back(std::move(sample));
}

/// Waits for a command or an interval to compute. Returns false when the object is destroyed.
bool LiveRun::wait_for_work(std::vector<Command>& commands) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return quits_ || running_ || single_steps_ > 0 || !commands_.empty(); });
  commands.swap(commands_);
  return !quits_;
}

void LiveRun::loop() {
  std::vector<Command> commands;
  for (; wait_for_work(commands); commands.clear()) {
    perform(commands);
    bool advances = false;
    {
      const std::lock_guard lock(mutex_);
      advances = failure_.empty() && (running_ || single_steps_ > 0);
      single_steps_ = std::max(0, single_steps_ - 1);
      running_ = running_ && failure_.empty();
    }
    if (advances) advance();
    publish();
    if (advances) keep_pace();
  }
  perform(commands);
}

void LiveRun::perform(std::vector<Command>& commands) {
  if (commands.empty()) return;
  const WallClock::time_point start = WallClock::now();
  for (Command& command : commands) {
    try {
      refusal_.clear();
      command(simulation_);
    } catch (const std::exception& failure) {
      refusal_ = failure.what();
    }
  }
  clock_->skip_since(start);
}

void LiveRun::advance() {
  const WallClock::time_point start = WallClock::now();
  try {
    simulation_.advance();
    if (clock_->ledger_is_old()) {
      ledger_ = simulation_.ledger();
      clock_->note_ledger();
    }
  } catch (const std::exception& failure) {
    failure_ = failure.what();
  }
  clock_->interval_cost = seconds_since(start);
}

void LiveRun::publish() {
  sample_tracks();
  const auto next = std::make_shared<Snapshot>();
  next->state = simulation_.simulation().state();
  next->ledger = ledger_;
  next->interval_cost = clock_->interval_cost;
  next->dragging = simulation_.is_dragging();
  if (next->dragging) {
    const Drag& drag = simulation_.drags().back();
    next->held = PlacedPoint(simulation_.simulation().model(), drag.spring->a).at(next->state);
    next->target = drag.target;
  }
  if (failure_.empty()) {
    const Simulation& simulation = simulation_.simulation();
    if (shown_.contacts) next->forces.contacts = contact_forces(simulation);
    if (shown_.joints) next->forces.joints = joint_forces(simulation.dynamics(), simulation.state());
    if (shown_.loads) next->forces.loads = load_forces(simulation.dynamics(), simulation.state());
  }
  next->failure = failure_;
  next->refusal = refusal_;
  next->report = report_;
  const std::lock_guard lock(mutex_);
  next->running = running_ && failure_.empty();
  if (next->running) {
    next->speed = clock_->speed(next->state.time());
    next->delay = clock_->delay();
  }
  snapshot_ = next;
}

/// Waits until the next interval is due, the simulation is paused, or the object is destroyed.
void LiveRun::keep_pace() {
  std::unique_lock lock(mutex_);
  if (!running_) return;
  const WallClock::time_point due = clock_->next_due(1 / simulation_.rate(), max_speed_);
  changed_.wait_until(lock, due, [&] { return quits_ || !running_; });
}

}  // namespace pliant
