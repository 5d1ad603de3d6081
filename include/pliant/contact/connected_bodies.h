// Sets of bodies that contacts connect. A body is a part, or all parts that joints connect.
#pragma once

#include <pliant/body/model.h>
#include <pliant/math/disjoint_sets.h>
#include <pliant/math/index.h>

namespace pliant {

class ConnectedBodies {
 public:
  /// The model must outlive this object. At first each body is a set of its own.
  explicit ConnectedBodies(const Model& model) : model_(model), sets_(model.parts().size()) {}

  /// Joins the sets of two parts at a contact. A part that cannot move, or -1, joins nothing.
  void connect(int a, int b) {
    const int one = body_of(a), other = body_of(b);
    if (one >= 0 && other >= 0) sets_.unite(one, other);
  }
  /// Returns the number of the set of two parts at a contact; -1 if neither part can move. The number of a
  /// set is the smallest part number that represents one of its bodies (body_of()).
  int set_of(int a, int b) {
    const int one = body_of(a), body = one >= 0 ? one : body_of(b);
    return body >= 0 ? sets_.root(body) : -1;
  }

 private:
  /// A body is represented by the first part of its island.
  int body_of(int part) const {
    if (part < 0 || model_.parts()[at(part)].q0 < 0) return -1;
    const int island = model_.parts()[at(part)].island;
    return island < 0 ? part : model_.islands()[at(island)].parts.front();
  }

  const Model& model_;
  DisjointSets sets_;
};

}  // namespace pliant
