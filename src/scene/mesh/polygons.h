// Faces with any number of corners, as in a mesh file, and their division into triangles.
#pragma once

#include <string>
#include <vector>

#include "raw_mesh.h"

namespace pliant {

/// The faces in the order of the file. corners: vertex numbers of all faces, one face after the other; sizes:
/// number of corners of each face, at least 3.
struct Polygons {
  std::vector<int> corners, sizes;
};

/// Appends the triangles of the polygons to a mesh. Convex polygons become fans about their first corner;
/// from other polygons ears are cut until a triangle remains. Throws std::invalid_argument for a polygon of
/// more than 1000 corners that is not convex, and for more than kMaxTriangles triangles. name: the file, for
/// messages.
void add_polygons(const Polygons& polygons, const std::string& name, RawMesh& mesh);

}  // namespace pliant
