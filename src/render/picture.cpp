// The bounding box of a picture.
#include <pliant/render/picture.h>

namespace pliant {

Eigen::AlignedBox3d bounds(const Picture& picture) {
  Eigen::AlignedBox3d box;
  for (const Picture::Body& body : picture.bodies)
    if (body.mesh)
      for (Eigen::Index i = 0; i < body.mesh->x.cols(); ++i) box.extend(body.mesh->x.col(i));
  for (const Picture::Track& track : picture.tracks)
    for (const Eigen::Vector3d& point : track.points) box.extend(point);
  return box;
}

}  // namespace pliant
