// A closed triangle mesh of the surface of a part, for pictures and mesh files.
#pragma once

#include <Eigen/Core>

namespace pliant {

/// Triangles are counter-clockwise seen from outside. The triangles at one vertex may have different normals
/// there, so that the edges of a box are sharp without duplicate vertices.
struct TriangleMesh {
  Eigen::Matrix3Xd x;          ///< vertices, m
  Eigen::Matrix3Xd normals;    ///< unit normals
  Eigen::Matrix3Xi triangles;  ///< 3 x triangles: the column of x of each corner
  Eigen::Matrix3Xi corners;    ///< 3 x triangles: the column of normals of each corner
};

}  // namespace pliant
