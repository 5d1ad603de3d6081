// Sequential impacts (ImpactOrder::sequential): where several bodies touch, impacts of pairs of bodies follow
// each other at one instant. The pair with the largest approach speed is always resolved next, until no pair
// approaches. The paper has no such law.
#pragma once

#include <vector>

#include <pliant/collision/find_contacts.h>
#include <pliant/contact/contact_resolution.h>

namespace pliant {

class ImpactSequence {
 public:
  /// All arguments must outlive this object.
  ImpactSequence(const ContactFinder& finder, ContactResolution& resolution)
      : finder_(finder), resolution_(resolution) {}

  /// Resolves the impacts at some contacts at step.t pair by pair. Each impact satisfies Newton's law and
  /// Coulomb's law at all contacts of its pair. Contact::rebound on input is a correction of the rebound in
  /// the first impact of the contact, m/s: (1 + restitution) times the normal velocity that accelerations
  /// have given its sides since they met. Pairs that approach equally fast, except for the residual of the
  /// impulses, are resolved together, so that symmetric motions stay symmetric. h: see ResolvedMotion.
  /// min_speed: approaches and rebounds slower than this (m/s) are ignored. Approaches up to twice
  /// ContactSettings::tolerance, as a share of the fastest approach of connected bodies at the start, are
  /// ignored, too. A sequence has at most 1000 impacts plus ten for each pair.
  /// If pairs still approach afterwards, StepCounters::contact_cutoffs grows by one. Without restitution
  /// there is no sequence: it would converge slowly to impulses that Newton's law at all contacts at once
  /// gives directly.
  void resolve(StepContext& step, const std::vector<Contact>& contacts, double h, double min_speed);

 private:
  /// The contacts of two bodies.
  struct Pair {
    std::vector<Contact> contacts;
    double approach;  ///< largest approach speed of a contact, m/s
    double slowest;   ///< approaches up to this speed are not treated as impacts, m/s

    bool has_impact() const { return approach > slowest; }
  };
  double approach(const State& state, const Contact& contact) const;
  double approach(const State& state, const Pair& pair) const;
  std::vector<Pair> pairs_of(const State& state, const std::vector<Contact>& contacts) const;
  static void set_slowest(const Model& model, double min_speed, std::vector<Pair>& pairs);
  std::vector<Contact> next_impacts(const State& state, double least, double min_speed,
                                    std::vector<Pair>& pairs) const;

  const ContactFinder& finder_;
  ContactResolution& resolution_;
};

}  // namespace pliant
