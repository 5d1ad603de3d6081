// Contacts of parts that deform locally: their nodes on planes, their surfaces as meshes against obstacles
// and other parts.
#pragma once

#include <map>
#include <memory>
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
  /// The model and its obstacles must outlive it.
  MeshFinder(const Model& model, const std::vector<ObstacleMesh>& obstacles = {});

  bool empty() const { return meshes_.empty(); }
  /// Where surfaces have gone through each other at a state and a time, s. Appends.
  void find(const State& state, double t, std::vector<Contact>& found) const;
  /// What a step from a state comes near to, on top of what is in `near` already. after: the state that it
  /// has led to; nullptr of one to come.
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
  /// A ball that a part is in, and the vertices of its mesh (body frame, m) where they told it.
  struct Around {
    int part;
    Vec3<double> c;
    double reach;
    Eigen::Matrix3Xd p;
  };
  bool is_soft(int part) const;
  ContactSide side(const PlacedMesh& placed, int part, const State& state, const MeshPoint& point,
                   const Vec3<double>& x) const;
  std::map<int, Around> balls(const State& state, double t) const;
  PlacedMesh place(const State& state, double t, const Around& ball) const;
  /// act(one, other) for each two things of a map over parts that may touch: meshes, whose boxes meet.
  template <class Thing, class F>
  void each_pair(const State& state, const std::map<int, Thing>& all, F&& act) const;
  Vec3<double> carries(int part, double t, const Vec3<double>& x) const;
  double own_way(const State& state, double t, const Around& ball) const;
  /// Whether parts are deeper in each other than a step leads them; touches: of their meshes.
  bool are_deep(const State& state, double t, const Around& one, const Around& other, const PlacedMesh& a,
                const PlacedMesh& b, const std::vector<MeshTouch>& touches) const;
  /// The way on which such parts leave each other as wholes.
  Contact way_out(const State& state, double t, const Around& one, const Around& other, const PlacedMesh& a,
                  const PlacedMesh& b) const;

  const Model* model_;
  std::map<int, ContactMesh> meshes_;  // of each part that needs one
  std::vector<OnPlane> planes_;
  std::vector<OnObstacle> on_obstacles_;
  ContactRules rules_;
};

}  // namespace pliant
