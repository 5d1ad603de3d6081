// Contact search of parts without local deformation. A tree of boxes finds the parts that are near each
// other. Ellipsoids, boxes and balls on boxes have closed forms. Other parts with support functions use these
// functions to find contacts with planes, and with each other if both parts are convex. Parts that are not
// convex touch each other at common normals of their faces, edges and vertices. Other contacts are the lowest
// points of each part over obstacles and over the parts near it.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <pliant/body/model.h>
#include <pliant/collision/collision_surface.h>
#include <pliant/collision/contact.h>
#include <pliant/collision/contact_rules.h>
#include <pliant/collision/mesh/obstacle_mesh.h>

namespace pliant {

class Hull;

/// The class is not thread-safe: its const functions write to scratch storage that is kept from call to call.
class ContactFinder {
 public:
  /// model: must outlive this object. The finder ignores parts that deform locally (see MeshFinder). Throws
  /// std::invalid_argument as ContactRules and ObstacleMesh do.
  explicit ContactFinder(const Model& model);
  /// Makes a finder for a model that contains some parts of a body. The new finder shares surfaces, rules and
  /// obstacles with `whole`, the finder of the whole body. The models of both must outlive the new finder.
  ContactFinder(const Model& model, const ContactFinder& whole);
  ~ContactFinder();

  /// Meshes of the obstacles, in the order of the settings. References are valid as long as this object
  /// exists.
  const std::vector<ObstacleMesh>& obstacles() const { return *obstacles_; }
  /// Whether the rules let two parts touch.
  bool may_touch(int a, int b) const { return has_pairs_ && rule_of(a, b).touch; }
  /// Returns the radius of a ball about the origin of a part that contains the part at a state, m.
  double reach(const State& state, int part) const;

  /// Finds the contacts at a state and a time t (s) whose gap is at most max_gap (m). Contacts are left out
  /// if neither side can move, because each side is immobile or sleeps. marked: one entry for each part; if
  /// given, only contacts with at least one marked part are found. Order: part by part, first planes and then
  /// obstacles; after these all pairs of parts.
  std::vector<Contact> find(const State& state, double t, double max_gap,
                            const std::vector<bool>* marked = nullptr) const;
  /// Whether find() finds the contacts of this pair, because neither side deforms locally. MeshFinder finds
  /// the contacts of all other pairs.
  bool finds(const Contact& contact) const {
    return (contact.a.part < 0 || surfaces_[at(contact.a.part)]) &&
           (contact.b.part < 0 || surfaces_[at(contact.b.part)]);
  }
  /// Whether one contact comes before another in the order of find().
  static bool precedes(const Contact& one, const Contact& other);
  /// Returns whether the contact point moves smoothly while the sides roll and slide. For this, one side must
  /// be a part without faces, edges and nearly flat regions, with the parameters of the last call of find().
  /// The other side must be a part, a plane or a flat obstacle (ObstacleMesh::is_flat).
  bool is_smooth(const Contact& contact) const;
  /// Returns a contact with a plane, moved to the state and time of the last call of find(). Side a keeps its
  /// material point; x, gap and prescribed_velocity change. Returns std::nullopt if the contact is not with
  /// a plane, if the plane does not act, or if the part has no support function. Also returns std::nullopt
  /// for a part without nearly flat regions, because its contact points are functions of the state.
  std::optional<Contact> follow(const Contact& contact) const;
  /// Returns the distance (m) below which two contact points of part contact.a are merged into one. contact:
  /// its side a is a part without local deformation.
  double merge_distance(const Contact& contact) const;
  /// Returns the velocity of side a relative to side b at a contact, m/s, world. It includes the prescribed
  /// motion (Contact::prescribed_velocity).
  Vec3<double> velocity(const State& state, const Contact& contact) const;
  /// Returns the largest admissible depth of a contact, m: kMaxTravelShare times the thickness of its thinner
  /// part. The search may find a deeper contact on the far side of this part, where the normal is wrong. The
  /// function is only for parts without local deformation.
  double max_resolved_depth(const Contact& contact) const;
  /// Largest motion of two touching parts relative to each other in a step, as a share of the thickness of
  /// the thinner part.
  static constexpr double kMaxTravelShare = 0.4;
  /// Result of the search before a step: whether anything can touch during the step, and the largest length
  /// of the step.
  struct Neighbourhood {
    bool empty = true;  ///< nothing can touch during the step
    bool soft = false;  ///< parts that deform locally may touch something; MeshFinder::approach() sets it
    double h = 0;       ///< largest step in which no part passes through another part or an obstacle, s
    /// Distance that each part may move beyond the predicted motion without changing this result, m.
    double spare = 0;

    /// Limits `spare` and `h` for two sides that move relative to each other in a step of `whole` seconds. h
    /// is reduced if they move by more than max_travel (m). travel: their motion at the velocities of the
    /// start of the step, m. change: the additional motion by the change of these velocities, m. done:
    /// whether the step is already done; then an excess of one eighth of max_travel is tolerated.
    void limit_travel(double travel, double change, double max_travel, double whole, bool done);
  };
  /// Returns the neighbourhood of a coming step that starts at time t (s) and lasts h seconds. reach: the
  /// displacement by a constant acceleration in the step, as a multiple of acceleration * h^2; it depends on
  /// the method (see Integrator). Gravity is the only force in the predicted motion.
  Neighbourhood neighbourhood(const State& state, double t, double h, double reach = 0.5) const;
  /// Returns the neighbourhood of a step that has led to the state `after`. foreseen: the result of
  /// neighbourhood() for this step or a longer one. `foreseen` is returned if the motion of no part exceeded
  /// the prediction by more than foreseen.spare.
  Neighbourhood neighbourhood_of(const State& state, const State& after, double t, double h, double reach,
                                 const Neighbourhood& foreseen) const;
  /// Returns the least gap between the two sides of a contact at a state and a time t (s), m; max_gap if the
  /// least gap is larger. Over an obstacle the result is also at most a tenth of the size of the part.
  double min_gap(const State& state, double t, const Contact& contact, double max_gap) const;

 private:
  struct Placed;
  struct Scratch;
  class OverPart;
  void set_up();
  ContactRule rule_of(int a, int b) const;
  void place(const State& state, double t, int part) const;
  bool has_fixed_shape(int part) const;
  bool uses_hull(int part) const;
  Hull hull_of(int part) const;
  bool is_convex(int part) const;
  bool is_round(int part) const;
  const Eigen::Matrix3Xd& points_of(int part) const;
  /// after: the end of a step that is done; nullptr for a coming step.
  Neighbourhood neighbourhood(const State& state, const State* after, double t, double h, double reach) const;
  std::pair<double, double> relative_speed(const State& state, int part, int from) const;
  double clearance(int ball, int box) const;
  void place_ball(const State& state, const State* after, double t, double h, double reach, int part) const;
  Eigen::AlignedBox3d body_box(int part) const;
  Eigen::AlignedBox3d world_box(int part) const;
  void place_planes(double t) const;
  void find_near_pairs(double max_gap, const std::vector<bool>* marked) const;
  void find_on_plane(int a, std::size_t plane, double max_gap, std::vector<Contact>& found) const;
  void find_on_obstacle(int a, std::size_t obstacle, double t, double max_gap,
                        std::vector<Contact>& found) const;
  bool are_apart(int a, int b, double max_gap) const;
  Contact contact_at(const Vec3<double>& x, const Vec3<double>& normal, double gap, int a, int b,
                     const ContactRule& rule) const;
  void find_between_boxes(int a, int b, const ContactRule& rule, double max_gap,
                          std::vector<Contact>& found) const;
  bool find_between_hulls(int a, int b, const ContactRule& rule, double max_gap,
                          std::vector<Contact>& found) const;
  bool find_between_features(int a, int b, const ContactRule& rule, double max_gap,
                             std::vector<Contact>& found) const;
  bool find_ball_on_box(int a, int b, const ContactRule& rule, double max_gap,
                        std::vector<Contact>& found) const;
  void find_on_pair(int a, int b, const ContactRule& rule, double max_gap, std::vector<Contact>& found) const;
  Vec3<double> support_point(int part, const Vec3<double>& direction) const;
  bool find_deep_overlap(int a, int b, const ContactRule& rule, std::vector<Contact>& found) const;
  /// Appends the low points of a over b.
  void find_on_part(int a, int b, const ContactRule& rule, double max_gap, std::vector<Contact>& found) const;

  const Model* model_;
  std::vector<std::shared_ptr<const CollisionSurface>> surfaces_;  // nullptr for parts that deform locally
  std::shared_ptr<const ContactRules> rules_;                      // of the whole body
  std::vector<ContactRule> on_planes_;                             // index: part * number of planes + plane
  std::shared_ptr<const std::vector<ObstacleMesh>> obstacles_;
  std::vector<ContactRule> on_obstacles_;  // index: part * number of obstacles + obstacle
  bool has_pairs_;                         // whether parts may touch parts
  std::vector<int> smooth_parts_;          // numbers of the parts without local deformation
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace pliant
