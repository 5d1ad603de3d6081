// Kinds of solids for the tests of contact search: shape, chain of deformations and parameters.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/part/part.h>

#include "draws.h"

namespace pliant::test {

/// A shape with a chain of deformations and rest values. name: description for messages.
struct SolidKind {
  const char *name, *shape;
  std::vector<std::string> chain;
  Part::Named rest;
  bool is_smooth = false;  ///< whether the normal is continuous
};

inline Eigen::Quaterniond random_rotation(Draws& draws) {
  return Eigen::Quaterniond(draws.uniform(-1, 1), draws.uniform(-1, 1), draws.uniform(-1, 1),
                            draws.uniform(-1, 1))
      .normalized();
}

}  // namespace pliant::test
