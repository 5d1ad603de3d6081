// Contact search of parts that deform locally: their nodes against planes, and their surface meshes against
// obstacles and other parts.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <pliant/collision/contact.h>
#include <pliant/collision/contact_rules.h>
#include <pliant/collision/find_contacts.h>
#include <pliant/collision/mesh/contact_mesh.h>
#include <pliant/collision/mesh/mesh_touches.h>
#include <pliant/collision/mesh/obstacle_mesh.h>

namespace pliant {

class MeshFinder {
 public:
  /// model, obstacles: must outlive this object.
  MeshFinder(const Model& model, const std::vector<ObstacleMesh>& obstacles = {});

  /// Returns true if no part that deforms locally may touch anything.
  bool empty() const { return meshes_.empty(); }
  /// Appends the contacts of surfaces that overlap at a state and a time t (s).
  void find(const State& state, double t, std::vector<Contact>& found) const;
  /// Updates the neighbourhood of a step of h seconds with the parts that deform locally: sets soft and
  /// empty, and reduces h and spare. after: the state at the end of a step that is done; nullptr for a coming
  /// step. reach: see ContactFinder::neighbourhood().
  void approach(const State& state, const State* after, double t, double h, double reach,
                ContactFinder::Neighbourhood& near) const;

 private:
  struct OnPlane {
    int part;
    std::size_t plane;
    ContactRule rule;
  };
  struct OnObstacle {
    int part;
    std::size_t obstacle;
    const ObstacleMesh* mesh;
    ContactRule rule;
  };
  /// A ball that contains a part, and the vertices of its mesh (body frame, m) if the radius was computed
  /// from all of them.
  struct BoundingBall {
    int part;
    Vec3<double> c;
    double reach;
    Eigen::Matrix3Xd p;
  };
  bool deforms_locally(int part) const;
  ContactSide side(const PlacedMesh& placed, int part, const State& state, const MeshPoint& point,
                   const Vec3<double>& x) const;
  std::map<int, BoundingBall> balls(const State& state, double t) const;
  PlacedMesh place(const State& state, double t, const BoundingBall& ball) const;
  /// Calls act(one, other, rule) for each pair of parts that may touch and whose balls meet. At least one
  /// part of a pair deforms locally, and at least one moves. all: part number -> thing; one and other are
  /// values of this map. A Thing has the members part (number of the part), c and reach (centre and radius of
  /// its ball).
  template <class Thing, class F>
  void each_pair(const State& state, const std::map<int, Thing>& all, F&& act) const;
  Vec3<double> frame_velocity(int part, double t, const Vec3<double>& x) const;
  double local_travel(const State& state, double t, const BoundingBall& ball) const;
  /// Whether two parts overlap deeply. This is so if one of them contains the centre of the other. It is also
  /// so if an overlap exceeds a share of the thickness of the thinner part and a multiple of the motion of
  /// the parts in the last step. touches: the overlaps of their meshes. The function has seven parameters
  /// because the caller has computed the balls and the meshes already.
  bool is_deep_overlap(const State& state, double t, const BoundingBall& one, const BoundingBall& other,
                       const PlacedMesh& a, const PlacedMesh& b, const std::vector<MeshTouch>& touches) const;
  /// Returns one contact that separates two parts in deep overlap.
  Contact separation_contact(const State& state, double t, const BoundingBall& one, const BoundingBall& other,
                             const PlacedMesh& a, const PlacedMesh& b) const;

  const Model* model_;
  // Meshes of the parts that deform locally, and of the parts that may touch these, by number of the part.
  std::map<int, ContactMesh> meshes_;
  std::vector<OnPlane> planes_;
  std::vector<OnObstacle> on_obstacles_;
  std::optional<ContactRules> rules_;  // only if a part deforms locally
};

}  // namespace pliant
