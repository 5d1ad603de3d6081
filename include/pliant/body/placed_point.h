// A point whose place is asked for at many states: where it is among the nodes of its part is found once.
#pragma once

#include <pliant/body/model.h>

namespace pliant {

class PlacedPoint {
 public:
  /// The model must outlive it.
  PlacedPoint(const Model& model, Point point);

  const Point& point() const { return point_; }
  /// m, world.
  Vec3<double> at(const State& state) const;

 private:
  const Model* model_;
  Point point_;
  int part_;  // -1: of the world
  NodeWeights among_nodes_;
};

}  // namespace pliant
