// Which surfaces meet: a tree of boxes tells which parts are near each other, then the low points of each
// part over planes, obstacles and other parts.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <pliant/body/model.h>
#include <pliant/collision/collision_surface.h>
#include <pliant/collision/contact.h>
#include <pliant/collision/contact_rules.h>
#include <pliant/collision/mesh/obstacle_mesh.h>

namespace pliant {

/// Not for several threads at once: it keeps what it works with from call to call.
class ContactFinder {
 public:
  /// The model must outlive it. Parts that deform locally are MeshFinder's. Throws std::invalid_argument, see
  /// ContactRules and ObstacleMesh.
  explicit ContactFinder(const Model& model);
  ~ContactFinder();

  /// Meshes of the obstacles, in their order; they stay where they are as long as this does.
  const std::vector<ObstacleMesh>& obstacles() const { return obstacles_; }

  /// Contacts at a state and a time (s) whose gap is at most `most` (m); of: only those of parts that it
  /// marks. Of each part in turn those with planes, then with obstacles; after all of them those of pairs.
  std::vector<Contact> find(const State& state, double t, double most,
                            const std::vector<bool>* of = nullptr) const;
  /// Whether one contact comes before another in that order.
  static bool precedes(const Contact& one, const Contact& other);
  /// Velocity of side a against side b at a contact, m/s, world.
  Vec3<double> velocity(const State& state, const Contact& contact) const;
  /// How far sides of a contact may go into each other for it to be told where they touch, m.
  double thin(const Contact& contact) const;
  /// Share of the thinner of two parts that they may move against each other in a step.
  static constexpr double kThinShare = 0.4;
  /// What a step of h seconds from a state comes near to.
  struct Neighbourhood {
    bool empty = true;  ///< nothing touches in it
    bool soft = false;  ///< parts that deform locally may touch something
    double h = 0;       ///< so long that no part passes through another, s
    /// How much further than foreseen each part may go without that changing, m.
    double spare = 0;

    /// Shortens h where sides go more than `most` against each other in a step of `whole` seconds: by `way`
    /// at the velocities of its start and by `gained` as these change. In a step that is taken already they
    /// may do so by a little.
    void keep_within(double way, double gained, double most, double whole, bool taken);
  };
  /// reach: how far a force moves a body in the step (Integrator); of forces only gravity is foreseen.
  Neighbourhood neighbourhood(const State& state, double t, double h, double reach = 0.5) const;
  /// Of a step that has led to `after`; foreseen: what was told of one as long or longer.
  Neighbourhood neighbourhood_of(const State& state, const State& after, double t, double h, double reach,
                                 const Neighbourhood& foreseen) const;
  /// The least gap of a part over another, a plane or an obstacle, m; no more than `most`.
  double least_gap(const State& state, double t, const Contact& of, double most) const;

 private:
  struct Placed;
  struct Scratch;
  class OverPart;
  void place(const State& state, double t, int part) const;
  bool is_still(int part) const;
  const Eigen::Matrix3Xd& points_of(int part) const;
  /// after: of a step that is taken; nullptr of one to come.
  Neighbourhood neighbourhood(const State& state, const State* after, double t, double h, double reach) const;
  std::pair<double, double> speed_seen(const State& state, int part, int from) const;
  double clearance(int ball, int box) const;
  void place_ball(const State& state, const State* after, double t, double h, double reach, int part) const;
  Eigen::AlignedBox3d body_box(int part) const;
  Eigen::AlignedBox3d world_box(int part) const;
  void place_planes(double t) const;
  void find_near_pairs(double most, const std::vector<bool>* of) const;
  void find_on_plane(int a, std::size_t plane, double most, std::vector<Contact>& found) const;
  void find_on_obstacle(int a, std::size_t obstacle, double t, double most,
                        std::vector<Contact>& found) const;
  bool are_apart(int a, int b, double most) const;
  Contact contact_at(const Vec3<double>& x, const Vec3<double>& normal, double gap, int a, int b,
                     const ContactRule& rule) const;
  void find_between_boxes(int a, int b, const ContactRule& rule, double most,
                          std::vector<Contact>& found) const;
  bool find_ball_on_box(int a, int b, const ContactRule& rule, double most,
                        std::vector<Contact>& found) const;
  void find_between(int a, int b, const ContactRule& rule, double most, std::vector<Contact>& found) const;
  Vec3<double> farthest(int part, const Vec3<double>& direction) const;
  /// The way out of bodies that hold each other's centres; whether they do.
  bool find_deep(int a, int b, const ContactRule& rule, std::vector<Contact>& found) const;
  /// Low points of a over b.
  void find_on_part(int a, int b, const ContactRule& rule, double most, std::vector<Contact>& found) const;

  const Model* model_;
  std::vector<std::unique_ptr<CollisionSurface>> surfaces_;  // of each part that is this class's
  ContactRules rules_;
  std::vector<ContactRule> on_planes_;  // part after part, plane after plane
  std::vector<ObstacleMesh> obstacles_;
  std::vector<ContactRule> on_obstacles_;  // likewise
  bool any_pairs_;                         // whether parts may touch parts
  std::vector<int> smooth_;                // numbers of these parts
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace pliant
