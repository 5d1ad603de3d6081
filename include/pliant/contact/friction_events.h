// The times at which friction changes its kind within a motion: a sliding contact stops or reverses, or a
// sticking contact begins to slip. The forces of friction, or their rates, jump at these times. The paper has
// no such search.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <pliant/collision/find_contacts.h>
#include <pliant/contact/contact_pairs.h>
#include <pliant/contact/contact_problem.h>
#include <pliant/contact/contact_resolution.h>
#include <pliant/contact/free_motion.h>
#include <pliant/contact/resting_contacts.h>
#include <pliant/contact/sleeping.h>
#include <pliant/method/integrator.h>

namespace pliant {

class FrictionEvents {
 public:
  /// All arguments must outlive this object.
  FrictionEvents(const Dynamics& dynamics, const ContactFinder& finder, RestingContacts& resting,
                 const ContactResolution& resolution, const Sleeping& sleeping);

  /// The motion that is examined. step.state: the state at its end, without contact impulses.
  struct Examined {
    const Integrator& method;
    StepContext& step;
    const FreeMotion& free;
    const std::vector<Contact>& resting;   ///< resting contacts at its start
    const std::vector<Contact>& contacts;  ///< contacts at its end
  };
  /// Returns the time from the start of the motion to the first event that is found at its resting contacts,
  /// s. Returns std::nullopt if no event is found before the end of the motion. If a contact stops and then
  /// slides in the same direction again within the motion, the search does not find this event. tolerance:
  /// tolerance of the simulation; a contact that slides more slowly than the tolerance allows is treated as
  /// sticking.
  /// Contacts at nodes of meshes have no events.
  std::optional<double> first(const Examined& motion, double tolerance);

 private:
  /// A resting contact at the start of the motion.
  struct Start {
    PairKey pair;
    double speed;            ///< tangential speed, m/s
    Vec3<double> offset;     ///< from part a to the contact point, m, world
    Vec3<double> direction;  ///< unit vector of sliding; zero: the contact sticks
    bool sticks() const { return direction.isZero(0); }
    bool slides() const { return !sticks(); }
  };
  /// A contact at the end of a trial motion, with a positive normal impulse.
  struct End {
    int start;                ///< number of the contact at the start
    Vec3<double> slip;        ///< tangential velocity after the impulses, m/s
    double use;               ///< tangential impulse, divided by friction times the normal impulse
    double allowed_slip = 0;  ///< a contact that slips more slowly than this in a probe sticks, m/s
  };
  /// A motion from some state, and its state and contacts after the impulses.
  struct Trial {
    FreeMotion free;
    State state;
    std::vector<Contact> contacts;
    std::vector<End> ends;
  };

  void find_starts(const Examined& motion, double tolerance);
  void drop_short_slides(const Examined& motion, const Trial& end);
  Trial trial(const Examined& motion, const State& from, double begin, double h,
              const std::vector<Contact>& resting);
  Trial trial(const Examined& motion, double tau);
  Trial probe(const Examined& motion, const Trial& from);
  double slip_before(const FreeMotion& free, const std::vector<Contact>& resting,
                     const Contact& contact) const;
  void resolve(const Examined& motion, const std::vector<Contact>& resting, Trial& trial);
  int start_of(const Contact& contact, const State& state, double t) const;
  bool must_probe(const Examined& motion, const Trial& end);
  bool are_forces_constant(const Examined& motion);
  void find_directions(const Examined& motion);
  double least_sliding(const Trial& trial) const;
  double slip_acceleration(const Examined& motion, const Trial& trial);
  std::optional<double> stop(const Examined& motion, const Trial& end);
  std::optional<double> slip(const Examined& motion, const Trial& end);
  Vec3<double> offset(const Contact& contact, const State& state, double t) const;

  const Dynamics& dynamics_;
  const ContactFinder& finder_;
  RestingContacts& resting_;
  const ContactResolution& resolution_;
  const Sleeping& sleeping_;
  /// A second instance of the method of the simulation, for trial motions.
  std::unique_ptr<Integrator> method_;
  Workspace<double> work_;
  std::vector<Start> starts_;
  double short_ = 0;  ///< shorter slides are ignored, m
  double slow_ = 0;   ///< slower sliding is treated as sticking, m/s
};

}  // namespace pliant
