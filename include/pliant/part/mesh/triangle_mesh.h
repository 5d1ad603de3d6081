// A closed triangle mesh of a part's surface, as pictures and mesh files take it.
#pragma once

#include <Eigen/Core>

namespace pliant {

/// Triangles are counter-clockwise seen from outside. Several corners of one vertex may carry different
/// normals: that is how an edge of a box stays sharp while the mesh has no duplicate vertices.
struct TriangleMesh {
  Eigen::Matrix3Xd x;          ///< vertices, metres
  Eigen::Matrix3Xd normals;    ///< unit normals
  Eigen::Matrix3Xi triangles;  ///< columns of x, one triple a triangle
  Eigen::Matrix3Xi corners;    ///< columns of normals, one triple a triangle, beside triangles
};

}  // namespace pliant
