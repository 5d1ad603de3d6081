// Which parts, planes and obstacles touch, and how: the pairs and groups of ContactSettings, for things by
// number.
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

/// Size (m) of the smaller of the parts that a contact is of.
double smaller_size(const Model& model, const Contact& contact);

class ContactRules {
 public:
  /// The model must outlive it. Throws std::invalid_argument for numbers out of range, and for names that are
  /// not there or stand for two things.
  explicit ContactRules(const Model& model);

  /// Of two parts, in any order, and of a part and a plane or an obstacle.
  ContactRule of_parts(int a, int b) const;
  ContactRule on_plane(int part, int plane) const;
  ContactRule on_obstacle(int part, int obstacle) const;

 private:
  const ContactPair* pair(int a, int b) const;
  int number_of(int a, int b) const;
  ContactRule rule_of(const ContactPair* pair) const;
  ContactRule on_fixed(int part, int thing) const;
  bool moves(int part) const { return model_->parts()[static_cast<std::size_t>(part)].q0 >= 0; }

  const Model* model_;
  int n_parts_, n_planes_;
  // Parts, planes, obstacles and groups, in this order, have one number each; of two the lower comes first.
  std::vector<std::vector<int>> groups_of_;       // of each thing but these
  std::map<std::pair<int, int>, int> last_pair_;  // of these names, its number in the settings
  std::set<std::pair<int, int>> joined_;          // parts that a joint ties
};

}  // namespace pliant
