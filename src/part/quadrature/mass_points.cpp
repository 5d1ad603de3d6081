// The placement of mass points. The search checks rules on the integrands of M and g_q, Eq. (11).
#include <pliant/part/quadrature/mass_points.h>

#include <Eigen/Cholesky>

#include <pliant/math/scalar/power_of_two.h>

#include "rule_search.h"

namespace pliant {

using namespace rule_search;

namespace {

/// Points in packs of four. Unused lanes have mass 0.
struct Packed {
  std::vector<Material<Pack>> at;
  std::vector<Pack> mass;
};
Packed pack(const std::vector<RestPoint>& points, double density) {
  Packed out;
  for (std::size_t first = 0; first < points.size(); first += Pack::kLanes) {
    std::array<Material<double>, Pack::kLanes> four;
    Pack mass(0.0);
    for (std::size_t i = 0; i < Pack::kLanes; ++i) {
      const std::size_t k = first + i;
      four[i] = points[std::min(k, points.size() - 1)].at;
      if (k < points.size()) mass.set(static_cast<int>(i), density * points[k].mass);
    }
    out.at.push_back(gather(four.data()));
    out.mass.push_back(mass);
  }
  return out;
}

/// Integrands of the mass matrix and of the inertial forces: (L a).(L b) and (L a).x_ddot for random
/// generalised velocities a and b at random states. x_ddot is the acceleration of a point if all generalised
/// accelerations are zero.
class MassIntegrands {
 public:
  static constexpr const char* subject = "mass matrix";
  static constexpr int kEach = 3;
  static constexpr double kTolerance = 2e-14, kThin = 1e-15, kRequired = 1e-12;

  explicit MassIntegrands(const RestShape& shape) : shape_(shape), ranges_(shape.part) {}
  int n() const { return ranges_.n(); }

  /// Returns the contribution of each node of one direction (row) to each integral (column).
  Eigen::MatrixXd shares(const Columns& line, int n_states) const {
    Eigen::MatrixXd F = Eigen::MatrixXd::Zero(line.n_nodes, kEach * n_states);
    Draw draw;
    std::vector<Packed> packed;
    for (const Column& column : line.columns) packed.push_back(pack(column.points, 1));
    for (int state = 0; state < n_states; ++state) {
      const std::size_t place = static_cast<std::size_t>(state) % line.columns.size();
      add_state(draw, state, line.columns[place], packed[place], F.middleCols(kEach * state, kEach));
    }
    return F;
  }

 private:
  void add_state(Draw& draw, int state, const Column& column, const Packed& packed,
                 Eigen::Ref<Eigen::MatrixXd> F) const {
    VecMax<double> q, rate;
    ranges_.draw(draw, state, q, rate);
    Vec3<double> omega;
    for (int i = 0; i < 3; ++i) omega[i] = draw.symmetric();
    Eigen::MatrixXd mix(6 + n(), kEach + 2);
    for (Eigen::Index i = 0; i < mix.size(); ++i) mix.data()[i] = draw.symmetric();

    const auto count = static_cast<Eigen::Index>(column.points.size());
    if (count == 0) return;
    Kinematics all = kinematics(packed, count, shape_.part.parameters().expand<double>(q, rate), omega);
    if (!scale_columns(column.points, all)) return;
    const Eigen::MatrixXd moved = all.L * mix;
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto index = static_cast<std::size_t>(k);
      const double m = column.points[index].mass;
      const auto at = moved.middleRows<3>(3 * k);
      F(column.node[index], 0) += m * at.col(0).dot(at.col(1));
      F(column.node[index], 1) += m * at.col(2).dot(at.col(3));
      F(column.node[index], 2) += m * at.col(4).dot(all.acceleration.segment<3>(3 * k));
    }
  }

  /// L of Eq. (9) and the acceleration x_ddot of all points in the body frame: three rows for each point.
  struct Kinematics {
    Eigen::MatrixXd L;
    Eigen::VectorXd acceleration;
  };
  Kinematics kinematics(const Packed& packed, Eigen::Index count, const ParameterValues<double>& values,
                        const Vec3<double>& omega) const {
    Kinematics all{Eigen::MatrixXd(3 * count, 6 + n()), Eigen::VectorXd(3 * count)};
    constexpr int block = 8;
    std::array<Jet<Pack>, block> jets;
    for (std::size_t first = 0; first < packed.at.size(); first += block) {
      const int packs = static_cast<int>(std::min<std::size_t>(block, packed.at.size() - first));
      JetBatch<Pack> batch{jets.data(), packs, 0, Level::rates};
      shape_.part.jets(values, packed.at.data() + first, batch);
      for (int lane = 0; lane < packs * static_cast<int>(Pack::kLanes); ++lane) {
        const Eigen::Index point = static_cast<Eigen::Index>(first * Pack::kLanes) + lane;
        if (point >= count) break;
        const Jet<Pack>& jet = jets[static_cast<std::size_t>(lane) / Pack::kLanes];
        const int l = lane % static_cast<int>(Pack::kLanes);
        auto one = [l](const Vec3<Pack>& x) { return Vec3<double>(x[0][l], x[1][l], x[2][l]); };
        const Vec3<double> s = one(jet.s);
        auto rows = all.L.middleRows<3>(3 * point);
        rows.leftCols<3>().setIdentity();
        for (int i = 0; i < 3; ++i) rows.col(3 + i) = Vec3<double>::Unit(i).cross(s);
        for (int i = 0; i < n(); ++i) rows.col(6 + i) = one(jet.J[static_cast<std::size_t>(i)]);
        all.acceleration.segment<3>(3 * point) =
            omega.cross(omega.cross(s)) + 2 * omega.cross(one(jet.s1)) + one(jet.s2);
      }
    }
    return all;
  }

  /// Scales each column of L, and the acceleration, to a root mean square of 1, so that small entries of M
  /// count as much as large entries. Returns false if the points have no mass.
  static bool scale_columns(const std::vector<RestPoint>& points, Kinematics& all) {
    double mass = 0;
    for (const RestPoint& p : points) mass += p.mass;
    if (!(mass > 0)) return false;
    for (Eigen::Index c = 0; c < all.L.cols() + 1; ++c) {
      double square = 0;
      auto x = c < all.L.cols() ? Eigen::Ref<Eigen::VectorXd>(all.L.col(c))
                                : Eigen::Ref<Eigen::VectorXd>(all.acceleration);
      x /= power_of_two(x.lpNorm<Eigen::Infinity>());  // squares of tiny numbers would underflow
      for (std::size_t k = 0; k < points.size(); ++k)
        square += points[k].mass * x.segment<3>(3 * static_cast<Eigen::Index>(k)).squaredNorm();
      if (square > 0) x *= std::sqrt(mass / square);
    }
    return true;
  }

  const RestShape& shape_;
  StateRanges ranges_;
};

/// Returns the values of the parameters at time 0, with zero rates.
ParameterValues<double> initial_values(const Part& part) {
  const Parameters& all = part.parameters();
  VecMax<double> q_s(all.n_dynamic()), zero = VecMax<double>::Zero(all.n_dynamic());
  for (int k = 0; k < all.n_dynamic(); ++k) q_s[k] = all.moving(k).initial;
  return all.expand<double>(q_s, zero);
}

/// Returns three points in each of the plane sections that the search chooses. extra: number of levels of
/// refinement beyond the level that suffices.
PlacedPoints place_slices(const RestShape& shape, const MassIntegrands& integrands, int extra) {
  auto columns = [&](const std::vector<SliceNode>& nodes) {
    Columns line{{Column{}}, 0};
    for (const SliceNode& node : nodes) {
      add_slice(shape, node, line.columns[0].points);
      line.columns[0].end_node(line.n_nodes++);
    }
    return line;
  };
  PlacedPoints placed;
  placed.level = refine(integrands, placed.remaining,
                        [&](int level) { return columns(slice_nodes(shape, size_at(level))); });
  std::vector<SliceNode> nodes = slice_nodes(shape, size_at(placed.level + extra));
  if (shape.follows != Follows::affine) thin(integrands, columns(nodes), nodes);
  for (const SliceNode& node : nodes) add_slice(shape, node, placed.points);
  return placed;
}

/// Returns four points of equal mass with the mass, the centroid and the second moments of the given points.
std::vector<RestPoint> affine_points(const RestShape& r, const std::vector<RestPoint>& points) {
  const ShapeInterface& shape = r.part.shape();
  double m = 0;
  Vec3<double> first = Vec3<double>::Zero();
  Mat3<double> second = Mat3<double>::Zero();
  for (const RestPoint& p : points) {
    const Vec3<double> e = shape.e(p.at, r.a);
    m += p.mass;
    first += p.mass * e;
    second += p.mass * e * e.transpose();
  }
  // Moments that differ from zero by rounding only are set to zero. In slender bodies these rounding errors
  // would couple parameters that are not coupled.
  constexpr double noise = 1e-14;
  Vec3<double> centre = first / m;
  for (int i = 0; i < 3; ++i)
    if (std::abs(centre[i]) <= noise * std::sqrt(second(i, i) / m)) centre[i] = 0;
  Mat3<double> spread = second / m - centre * centre.transpose();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (std::abs(spread(i, j)) <= noise * std::sqrt(spread(i, i) * spread(j, j))) spread(i, j) = 0;
  const Mat3<double> L = spread.llt().matrixL();
  std::vector<RestPoint> four;
  for (int k = 0; k < 4; ++k) {
    const Vec3<double> corner(k < 2 ? 1 : -1, k % 2 == 0 ? 1 : -1, k == 0 || k == 3 ? 1 : -1);
    four.push_back({shape.label(centre + L * corner, r.a), m / 4});
  }
  return four;
}

}  // namespace

MassPoints place_mass_points(const Part& part, int doublings) {
  const RestShape shape(part);
  throw_if_folded(part, shape.rest, "rest");
  if (part.n_s() > 0) throw_if_folded(part, initial_values(part), "initial");
  const MassIntegrands integrands(shape);
  const bool affine = shape.follows == Follows::affine;
  PlacedPoints placed = shape.by_sections ? place_slices(shape, integrands, 2 * doublings)
                                          : RingSearch(shape, integrands, !affine, 2 * doublings).run();
  if (affine) placed.points = affine_points(shape, placed.points);
  remove_massless(placed.points);
  Packed packed = pack(placed.points, part.density());
  MassPoints out;
  out.at = std::move(packed.at);
  out.mass = std::move(packed.mass);
  out.n_points = static_cast<int>(placed.points.size());
  out.rule = affine ? "affine" : shape.by_sections ? "sections" : shape.points_apart ? "full" : "rings";
  out.level = placed.level;
  out.relative_error = placed.remaining;
  return out;
}

}  // namespace pliant
