// Sparse surfaces cover the surface of the part at every value of its dynamic parameters, and have few cells
// where the part is flat.
#include "catch.h"

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <pliant/body/model.h>
#include <pliant/collision/mesh/sparse_surface.h>
#include <pliant/part/registry.h>

namespace sparse_surface_test {

using namespace pliant;

namespace {

constexpr int kResolution = 6;
constexpr double kAnySize = std::numeric_limits<double>::infinity();
/// Number of vertices of a surface none of whose cells has been widened.
constexpr Eigen::Index kDense = 24 * kResolution * kResolution + 2;

struct Kind {
  std::string shape;
  std::vector<std::string> links;
  /// dynamic: values of the dynamic parameters at which the surfaces are compared.
  std::map<std::string, double> rest, dynamic;
  Eigen::Index vertices;  // number of vertices of the sparse surface
};

/// A body with one part of this kind.
class One {
 public:
  explicit One(const Kind& kind) {
    Part& part = body_.add(make_part(kind.shape, kind.shape, kind.links, 1000));
    for (const auto& [name, value] : kind.rest) part.rest({{name, value}});
    for (const auto& [name, value] : kind.dynamic) part.stiffness({{name, 1e3}});
    model_.emplace(body_);
  }
  const Part& part() const { return *model_->parts()[0].part; }

 private:
  MultiBody body_;
  std::optional<Model> model_;
};

double volume(const Part& part, const Surface& surface, const ParameterValues<double>& values) {
  return enclosed_volume(surface.body_mesh(part, values));
}

}  // namespace

TEST_CASE("a sparse surface covers the same surface with fewer vertices", "[collision]") {
  const int n = 2 * kResolution;
  const Eigen::Index rings = 4 * n;            // number of vertices on the edge of an end face
  const Eigen::Index cap = (n - 1) * (n - 1);  // number of vertices inside an end face
  const std::vector<Kind> kinds{
      {"box", {}, {{"a1", 0.3}}, {}, 8},
      {"box", {}, {{"a1", 0.3}}, {{"a1", 0.4}, {"a3", 2}}, 8},
      {"box", {"taper"}, {{"taper.tx", 0.5}}, {{"taper.ty", -0.3}}, 8},
      {"box", {"shear"}, {{"shear.sx", 0.4}}, {}, 8},
      {"box", {"bend"}, {{"a3", 3}}, {{"bend.angle", 0.9}}, 4 * (n + 1)},
      {"box", {"bend"}, {{"a3", 3}, {"bend.angle", 1.2}}, {}, 4 * (n + 1)},
      // The bend is oblique to the sides. The sides become cones, whose generators are straight.
      {"box", {"bend"}, {{"bend.direction", 0.7}}, {{"bend.angle", 0.9}}, 4 * (n + 1)},
      {"box", {"twist"}, {}, {{"twist.angle", 1.1}}, kDense},
      // The taper collapses the triangles at one end to zero area. sparse_surface() ignores such triangles
      // when it tests whether points are on the surface.
      {"cylinder", {"taper"}, {{"taper.tx", 1}, {"taper.ty", 1}}, {}, 2 * (rings + cap)},
      {"box", {"taper", "twist"}, {{"taper.tx", 1}, {"taper.ty", 0}, {"twist.angle", 1.5}}, {}, kDense},
      {"cylinder", {}, {}, {}, 2 * (rings + cap)},
      {"cone", {}, {}, {{"a1", 1.3}}, 2 * (rings + cap)},
      {"cylinder", {"bend"}, {}, {{"bend.angle", 0.5}}, kDense},
      {"ellipsoid", {}, {}, {}, kDense},
      {"superellipsoid", {}, {}, {{"eps1", 0.4}}, kDense},
  };
  for (const Kind& kind : kinds) {
    INFO(kind.shape << " " << (kind.links.empty() ? "" : kind.links.front()) << ", " << kind.dynamic.size());
    const One one(kind);
    const Part& part = one.part();
    const Surface dense(part, kResolution), sparse = sparse_surface(part, kResolution, kAnySize);
    CHECK(static_cast<Eigen::Index>(sparse.material().size()) == kind.vertices);
    ParameterValues<double> values = part.parameters().rest();
    for (const auto& [name, value] : kind.dynamic)
      values.b[static_cast<std::size_t>(part.parameters().find(name))] = value;
    const double expected = volume(part, dense, values);
    CHECK(volume(part, sparse, values) == Approx(expected).epsilon(1e-12));
    CHECK(expected > 0);
  }
}

TEST_CASE("the cells of a sparse surface are not larger than the given size", "[collision]") {
  const One one({"box", {}, {{"a1", 0.1}, {"a2", 0.5}, {"a3", 1.5}}, {}, 0});
  const Part& box = one.part();
  auto vertices = [&](double cell) { return sparse_surface(box, kResolution, cell).material().size(); };
  auto of_cells = [](int x, int y, int z) {
    return static_cast<std::size_t>(2 * (x * y + y * z + z * x) + 2);
  };
  CHECK(vertices(1) == of_cells(1, 1, 3));
  CHECK(vertices(0.25) == of_cells(1, 4, 12));
  CHECK(vertices(0.11) == of_cells(2, 12, 12));
  CHECK(vertices(0) == of_cells(12, 12, 12));
}

}  // namespace sparse_surface_test
