// Function bodies of PlacedPoint.
#pragma once

#include <utility>

#include <pliant/body/placed_point.h>
#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE PlacedPoint::PlacedPoint(const Model& model, Point point)
    : model_(&model),
      point_(std::move(point)),
      part_(point_.part == nullptr ? -1 : model.body().index(*point_.part)) {
  if (part_ >= 0) among_nodes_ = Model::node_weights(point_);
}

PLIANT_INLINE Vec3<double> PlacedPoint::at(const State& state) const {
  return part_ < 0 ? point_.world.value(state.time())
                   : model_->world_point(state, part_, point_.material, among_nodes_);
}

}  // namespace pliant
