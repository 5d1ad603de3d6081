// A point whose position is evaluated at many states. The weights of the point among the nodes of its part
// are computed once.
#pragma once

#include <pliant/body/model.h>

namespace pliant {

class PlacedPoint {
 public:
  /// The model must outlive the point.
  PlacedPoint(const Model& model, Point point);

  const Point& point() const { return point_; }
  /// Returns the position at a state, m, world.
  Vec3<double> at(const State& state) const;

 private:
  const Model* model_;
  Point point_;
  int part_;  // -1: a point of the world
  NodeWeights among_nodes_;
};

}  // namespace pliant
