// Which surfaces meet: broad phase by boxes, then the low points of each part over planes and other parts.
#pragma once

#include <memory>
#include <vector>

#include <pliant/body/model.h>
#include <pliant/contact/collision_surface.h>
#include <pliant/contact/contact.h>
#include <pliant/contact/contact_rules.h>

namespace pliant {

class ContactFinder {
 public:
  /// The model must outlive it. Parts that deform locally are MeshFinder's. Throws std::invalid_argument, see
  /// ContactRules.
  explicit ContactFinder(const Model& model);

  /// Contacts at a state and a time (s) whose gap is at most `most` (m).
  std::vector<Contact> find(const State& state, double t, double most) const;
  /// Velocity of side a against side b at a contact, m/s, world.
  Vec3<double> velocity(const State& state, const Contact& contact) const;
  /// What a step of h seconds from a state comes near to.
  struct Neighbourhood {
    bool empty = true;  ///< nothing touches in it
    double h = 0;       ///< so long that no part passes through another, s
  };
  Neighbourhood neighbourhood(const State& state, double t, double h) const;
  /// The least gap of a part over another or a plane, m; no more than `most`.
  double least_gap(const State& state, double t, const Contact& of, double most) const;

 private:
  struct Placed;
  /// Whether a part is this class's.
  bool smooth(int part) const;
  Placed place(const State& state, double t, int part) const;
  void find_on_plane(const Placed& a, std::size_t plane, double t, double most,
                     std::vector<Contact>& found) const;
  /// Low points of a over b.
  void find_on_part(const Placed& a, const Placed& b, const ContactRule& rule, double most,
                    std::vector<Contact>& found) const;

  const Model* model_;
  std::vector<std::unique_ptr<CollisionSurface>> surfaces_;  // of each part
  std::vector<ContactRule> on_planes_;                       // part after part, plane after plane
  std::vector<ContactRule> on_parts_;                        // of parts i < j, n_parts x n_parts
};

}  // namespace pliant
