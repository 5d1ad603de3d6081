// A simulation that a user drives while it runs: points are dragged; gravity, rest values and stiffnesses
// change.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pliant/math/time/linear_keys.h>
#include <pliant/scene/scene.h>
#include <pliant/simulate/simulation.h>
#include <pliant/view/stable_stiffness.h>

namespace pliant {

/// The piecewise linear path of a point of the world, which grows while it is in use.
struct GrowingPath {
  std::shared_ptr<LinearKeys> component[3];

  /// Makes the path with one key at a time t (s) and a point x.
  GrowingPath(double t, const Vec3<double>& x);
  void append(double t, const Vec3<double>& x);
  Vec3<double> last() const;
  double last_time() const { return component[0]->times().back(); }  ///< s
  TimeVector function() const;
};

/// A drag: the spring between a point of a part and a moving point of the world.
struct Drag {
  Spring* spring;        ///< of the body; spring->a is the point of the part
  MaterialAngles place;  ///< coordinates from which the material point can be computed again exactly
  GrowingPath path;      ///< of the point of the world
  Vec3<double> target;   ///< position to which the user has moved the point of the world, m
  double reach;          ///< largest movement of the point of the world in an interval, m
  bool ends = false;     ///< whether the drag ends at the end of the next interval
};

/// A rest value of a dynamic parameter that the user can change.
struct RestValue {
  const Part* part;
  std::string parameter;
  Range range;                       ///< allowed values
  double first;                      ///< value in the scene
  std::shared_ptr<LinearKeys> path;  ///< the values so far
  double next;                       ///< value at the end of the next interval
};

/// The stiffness of a spring of the scene, which the user can change.
struct SpringStiffness {
  Spring* spring;
  std::size_t number;  ///< of the spring in the scene
  double first;        ///< value in the scene, N/m
  double most;         ///< fixed steps are stable up to this value, at most 10 times `first`, N/m
  std::shared_ptr<LinearKeys> path;  ///< the values so far; nullptr if the user has not changed the stiffness
  double next;                       ///< value at the end of the next interval, N/m
};

/// The stiffness of a parameter of a part, which the user can change: a servo (body/actuation/drive.h) pulls
/// the parameter to its rest value, or pushes the parameter away from it, in addition to the stiffness of the
/// scene.
struct ParameterStiffness {
  std::size_t rest;                   ///< number of the parameter in LiveSimulation::rest_values()
  double first;                       ///< value in the scene, N/m or N m: the diagonal entry of K_s
  double least;                       ///< 0, or `first` if the row of K_s has other entries that are not zero
  double most;                        ///< fixed steps are stable up to this value, at most 100 times `first`
  Drive* servo;                       ///< nullptr if the user has not changed the stiffness
  std::shared_ptr<LinearKeys> added;  ///< the stiffnesses of the servo so far
  double next;  ///< value at the end of the next interval, with the stiffness of the servo included
};

/// The constant stiffness of a drive of a parameter, which the user can change.
struct DriveStiffness {
  Drive* drive;
  const Part* part;
  std::string parameter;
  double first;                      ///< value in the scene, N/m or N m
  double most;                       ///< fixed steps are stable up to this value, at most 10 times `first`
  std::shared_ptr<LinearKeys> path;  ///< the values so far; nullptr if the user has not changed the stiffness
  double next;                       ///< value at the end of the next interval
};

/// The stiffness of the local deformation of a part, which the user can change by a factor of all its laws
/// (PartDescription::scale_local).
struct LocalStiffness {
  const Part* part;
  double most;  ///< the fixed steps of the scene are stable up to this factor, at most 100
  std::shared_ptr<LinearKeys> path;  ///< the factors so far
  double next;                       ///< factor at the end of the next interval
};

/// Advances a scene by intervals of equal length, 1 / rate(). All actions of the user take effect between two
/// intervals, so that the motion can be repeated to the last bit (save_scene.h).
class LiveSimulation {
 public:
  /// Largest speed of the point of the world of a drag, in sizes of the part in a second; see drag_to().
  static constexpr double kMaxHandSpeed = 10;

  /// Prepares the scene, which must outlive the object, at time 0. display_rate (1/s): wanted number of
  /// intervals per second. With a fixed step, an interval is the nearest whole number of steps, at least one.
  /// Sets Scene::integrator to the chosen method and MultiBody::stop_rate. Throws what Simulation throws.
  explicit LiveSimulation(Scene& scene, double display_rate = 60, int threads = 1);

  /// Advances by one interval. Throws what Simulation::step() throws; the simulation is then at the end of
  /// the last good step, and only reset() and saving are then useful.
  void advance();
  /// Returns to time 0 and forgets all actions.
  void reset();

  double rate() const { return rate_; }                  ///< intervals per second, 1/s
  std::int64_t intervals() const { return intervals_; }  ///< intervals since time 0
  /// Time after a number of intervals, s.
  double time_after(std::int64_t intervals) const { return static_cast<double>(intervals) / rate_; }
  const Simulation& simulation() const { return *simulation_; }
  Ledger ledger() { return simulation_->ledger(); }
  const Scene& scene() const { return *scene_; }

  /// Begins to drag a point of a moving part by a spring of rest length 0 and a damper (N/m, N s/m) between
  /// this point and a point of the world, which starts at the position of the point. If the fixed steps of
  /// the scene would be unstable with these constants, the patch of the point grows and the constants are
  /// reduced (stable_stiffness.h).
  /// Throws std::invalid_argument if the point is not on a moving part, or for a negative or infinite
  /// constant.
  void grab(const Point& point, double stiffness, double damping);
  /// Moves the point of the world of the last drag to a position (m, world), where it arrives at the end of
  /// the next interval, or later. Its speed is at most the larger of kMaxHandSpeed sizes of the part and the
  /// extent of all parts, per second. A jump of the mouse would otherwise give a large force of the damper.
  void drag_to(const Vec3<double>& position);
  /// Ends the last drag at the end of the next interval.
  void release();
  /// Whether the last drag has not ended.
  bool is_dragging() const;
  /// Changes gravity (m/s^2, world) linearly within the next interval. If the gravity of the scene changes in
  /// time, `gravity` is added to the gravity of the scene.
  void set_gravity(const Vec3<double>& gravity);
  /// The gravity of the scene, if it changes in time.
  const std::optional<TimeVector>& changing_gravity() const { return changing_gravity_; }

  /// The rest values, constant in the scene, of those parameters of moving parts that have a stiffness. Parts
  /// with an elastic material (Part::continuum) are left out. The order does not change.
  const std::vector<RestValue>& rest_values() const { return rest_values_; }
  /// Changes a rest value linearly within the next interval. i: its number in rest_values(); value: m, rad
  /// or 1. Throws std::invalid_argument for a value out of range.
  void set_rest_value(std::size_t i, double value);

  /// The stiffnesses of those springs whose stiffness is constant and positive in the scene. Their order does
  /// not change.
  const std::vector<SpringStiffness>& stiffnesses() const { return stiffnesses_; }
  /// Changes the stiffness of a spring linearly within the next interval. i: its number in stiffnesses();
  /// value: N/m. From then on the spring is a muscle: its energy becomes work of actuation. Throws
  /// std::invalid_argument for a value that is negative or not finite.
  void set_stiffness(std::size_t i, double value);

  /// The stiffnesses of those parameters in rest_values() that have a positive stiffness and no drive.
  /// Parameters of a part that deforms locally are left out if the method of integration treats its
  /// elasticity implicitly: servos are explicit. The order does not change.
  const std::vector<ParameterStiffness>& parameter_stiffnesses() const { return parameter_stiffnesses_; }
  /// Changes the stiffness of a parameter linearly within the next interval. i: its number in
  /// parameter_stiffnesses(); value: N/m or N m. The energy of the servo is work of actuation. Throws
  /// std::invalid_argument for a value below ParameterStiffness::least, or not finite.
  void set_parameter_stiffness(std::size_t i, double value);

  /// The stiffnesses of those drives of parameters whose stiffness is constant and positive in the scene.
  /// Drives of parts whose local elasticity is integrated implicitly are left out. The order does not change.
  const std::vector<DriveStiffness>& drive_stiffnesses() const { return drive_stiffnesses_; }
  /// Changes the stiffness of a drive linearly within the next interval. i: its number in
  /// drive_stiffnesses(); value: N/m or N m. From then on the energy of the drive is work of actuation.
  /// Throws std::invalid_argument for a value that is negative or not finite.
  void set_drive_stiffness(std::size_t i, double value);

  /// The stiffnesses of the local deformation of moving parts that have no factor in the scene. A part whose
  /// fixed steps would be unstable with a smaller factor is left out. The order does not change.
  const std::vector<LocalStiffness>& local_stiffnesses() const { return local_stiffnesses_; }
  /// Changes the factor of the laws of a part linearly within the next interval. i: its number in
  /// local_stiffnesses(). The change does work of actuation. Throws std::invalid_argument for a factor that
  /// is negative or not finite.
  void set_local_stiffness(std::size_t i, double factor);

  /// All drags since time 0.
  const std::vector<Drag>& drags() const { return drags_; }
  /// The path of gravity, or of the vector that the user added to changing_gravity(); nullptr if the user has
  /// not changed gravity.
  const GrowingPath* gravity() const { return gravity_.get(); }

 private:
  void free_rest_values();
  void find_stiffnesses();
  void find_parameter_stiffnesses();
  void find_drive_stiffnesses();
  void bound_stiffnesses();
  void free_local_stiffnesses();
  void bound_local_stiffnesses();
  bool is_stable(const LocalStiffness& stiffness, double factor, double stable_without);
  void extend_paths(double now, double next);
  void rebuild();
  void continue_from(State state);
  SpringConstants bound_drag(const SpringConstants& constants, Point& at) const;
  std::string new_name() const;

  Scene* scene_;
  int threads_;
  std::int64_t steps_ = 0;  // fixed steps in an interval; 0 with a tolerance
  double rate_;
  std::unique_ptr<Simulation> simulation_;
  std::optional<StableStiffness> stable_;  // set by the constructor
  std::int64_t intervals_ = 0;
  std::vector<Drag> drags_;
  const std::optional<TimeVector> changing_gravity_;
  std::unique_ptr<GrowingPath> gravity_;
  std::vector<RestValue> rest_values_;
  std::vector<SpringStiffness> stiffnesses_;
  std::vector<ParameterStiffness> parameter_stiffnesses_;
  std::vector<DriveStiffness> drive_stiffnesses_;
  std::vector<LocalStiffness> local_stiffnesses_;
  Vec3<double> next_gravity_ = Vec3<double>::Zero();
};

/// Returns the stiffness of a spring on which the mass of the part oscillates twice in a second, and half of
/// the critical damping.
SpringConstants drag_spring(const Part& part);

}  // namespace pliant
