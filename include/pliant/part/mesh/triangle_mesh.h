// A closed triangle mesh of the surface of a part, for pictures and mesh files.
#pragma once

#include <Eigen/Core>

namespace pliant {

/// Triangles are counter-clockwise seen from outside. Corners of one vertex may have different normals, so
/// that the edges of a box stay sharp without duplicate vertices.
struct TriangleMesh {
  Eigen::Matrix3Xd x;          ///< vertices, m
  Eigen::Matrix3Xd normals;    ///< unit normals
  Eigen::Matrix3Xi triangles;  ///< for each triangle the columns of x of its corners
  Eigen::Matrix3Xi corners;    ///< for each triangle the columns of normals of its corners
};

}  // namespace pliant
