// The rule of each pair of parts, planes and obstacles: whether they may touch, their friction and their
// restitution. The rules are those of ContactSettings, resolved from names to numbers.
#pragma once

#include <map>
#include <set>
#include <utility>
#include <vector>

#include <pliant/body/model.h>
#include <pliant/collision/contact.h>

namespace pliant {

struct ContactRule {
  bool touch = true;
  double friction = 0, restitution = 0;
};

/// Returns the size (Part::size(), m) of the part of a contact, or of the smaller of its two parts.
double smaller_size(const Model& model, const Contact& contact);

class ContactRules {
 public:
  /// model: must outlive this object. Throws std::invalid_argument for numbers out of range, for unknown
  /// names, for a name that is used twice, for a group inside a group, and for a pair of a part, plane or
  /// obstacle with itself.
  explicit ContactRules(const Model& model);

  /// Returns the rule of two parts, in any order.
  ContactRule of_parts(int a, int b) const;
  /// Returns the rule of a part and a plane.
  ContactRule on_plane(int part, int plane) const;
  /// Returns the rule of a part and an obstacle.
  ContactRule on_obstacle(int part, int obstacle) const;

 private:
  const ContactPair* pair(int a, int b) const;
  int number_of(int a, int b) const;
  ContactRule rule_of(const ContactPair* pair) const;
  ContactRule on_fixed(int part, int thing) const;
  bool moves(int part) const { return model_->parts()[static_cast<std::size_t>(part)].q0 >= 0; }

  const Model* model_;
  int n_parts_, n_planes_;
  // Parts, planes, obstacles and groups are numbered together, in this order. The first number of a pair is
  // the smaller one.
  std::vector<std::vector<int>> groups_of_;       // groups of each part, plane and obstacle
  std::map<std::pair<int, int>, int> last_pair_;  // two numbers -> index of the last pair that names both
  std::set<std::pair<int, int>> joined_;          // parts that share a joint
};

}  // namespace pliant
