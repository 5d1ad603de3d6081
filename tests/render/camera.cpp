// The automatic camera shows a whole box, which fills 84 % of the width or of the height of the picture.
#include <limits>

#include "catch.h"
#include "scenes.h"

namespace camera_test {

using namespace pliant;

TEST_CASE("the automatic camera frames any box") {
  const Eigen::AlignedBox3d boxes[] = {
      {Eigen::Vector3d(-1, -2, 0), Eigen::Vector3d(4, 1, 0.5)},
      {Eigen::Vector3d(10, 20, 5), Eigen::Vector3d(10.1, 20.1, 9)},
      {Eigen::Vector3d(-1e-6, -1e-6, 0), Eigen::Vector3d(1e-6, 3e-6, 1e-6)},
      {Eigen::Vector3d(-1e6, -1, 0), Eigen::Vector3d(1e6, 1, 1)},
  };
  for (const Eigen::AlignedBox3d& box : boxes)
    for (const double aspect : {0.4, 1.0, 16.0 / 9}) {
      const Camera camera = automatic_camera(box, aspect);
      const int height = 1000, width = static_cast<int>(1000 * aspect);
      Eigen::AlignedBox2d seen;
      for (int i = 0; i < 8; ++i)
        seen.extend(test::pixel_of(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)), camera, width,
                                   height));
      const double fill = std::max(seen.sizes()[0] / width, seen.sizes()[1] / height);
      CAPTURE(aspect, box.sizes().transpose());
      CHECK(seen.min()[0] >= 0.07 * width);
      CHECK(seen.max()[0] <= 0.93 * width);
      CHECK(seen.min()[1] >= 0.07 * height);
      CHECK(seen.max()[1] <= 0.93 * height);
      CHECK(fill == Approx(0.84).epsilon(0.01));
      CHECK(camera.eye[2] > box.center()[2]);
    }
}

TEST_CASE("the automatic camera accepts an empty box and a point, and refuses infinite boxes") {
  const Camera camera = automatic_camera({}, 1.5);
  CHECK((camera.eye - camera.target).norm() > 1);
  const Eigen::Vector3d p(3, 4, 5);
  const Camera at_point = automatic_camera(Eigen::AlignedBox3d(p), 1.5);
  CHECK((at_point.eye - at_point.target).norm() > 0);
  CHECK(at_point.target == p);
  const double huge = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(automatic_camera({p, Eigen::Vector3d(huge, 5, 6)}, 1.5), std::invalid_argument);
  CHECK_THROWS_AS(automatic_camera({p, p}, 0), std::invalid_argument);
}

}  // namespace camera_test
