// The placement of mass points. The search checks rules on the integrands of M and g_q, Eq. (11).
#include <pliant/part/quadrature/mass_points.h>

#include <Eigen/Cholesky>

#include <pliant/math/scalar/power_of_two.h>
#include <pliant/part/quadrature/body_points.h>

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
  static constexpr double kTolerance = 2e-14, kRequired = 1e-12;
  /// For a mass distribution with jumps, no level suffices. The search then ends at level 9 (80 nodes in a
  /// panel) after seconds; kLastLevel would take a minute.
  int last_level() const { return shape_.distribution == nullptr ? kLastLevel : 9; }

  explicit MassIntegrands(const RestShape& shape) : shape_(shape), ranges_(shape.part) {
    if (shape.by_sections) return;
    constexpr int coarse = 3;
    const std::vector<AngleNode> v = ring_nodes(shape, coarse);
    for (const AngleNode& u : profile_nodes(shape, coarse))
      for (const QuadratureNode& w : depth_nodes(shape, coarse)) add_ring(shape, u, w, v, sample_);
  }
  int n() const { return ranges_.n(); }
  int n_states() const { return n() == 0 ? 8 : 48; }
  /// Returns the accuracy of thinning. In the radial map the kinks move with the exponents, and the
  /// integrands at some corners of the ranges differ from most others. With 3 integrands for each dimension
  /// (Thinning), errors of 7e-11 were measured for this map; with 12, errors below 1e-12. All other parts use
  /// 3: a bent and twisted cylinder then has errors of 4e-12 (1e-14 with 12), but a bent and twisted
  /// supertoroid would need more than 2 million points with 12.
  Thinning thinning() const {
    if (!shape_.dynamic_exponents) return {1e-15};
    return {1e-14, shape_.part.shape().bounded_exponents() ? 12 : 3};
  }

  /// Returns the contribution of each node of one direction (row) to each integral (column) at the states
  /// from number `first` to number end - 1.
  Eigen::MatrixXd shares(const Columns& line, int first, int end) const {
    Eigen::MatrixXd F = Eigen::MatrixXd::Zero(line.n_nodes, kEach * (end - first));
    Draw draw;
    std::vector<Packed> packed;
    for (const Column& column : line.columns) packed.push_back(pack(column.points, 1));
    for (int number = 0; number < end; ++number) {
      const State state = draw_state(draw, number);
      const std::size_t place = static_cast<std::size_t>(number) % line.columns.size();
      if (number >= first)
        add_state(state, line.columns[place], packed[place], F.middleCols(kEach * (number - first), kEach));
    }
    return F;
  }

 private:
  /// Values and rates of the parameters, angular velocity, and random generalised velocities (columns).
  struct State {
    int number;
    VecMax<double> q, rate;
    Vec3<double> omega;
    Eigen::MatrixXd mix;
  };
  State draw_state(Draw& draw, int number) const {
    State state{number, {}, {}, {}, Eigen::MatrixXd(6 + n(), kEach + 2)};
    ranges_.draw(draw, number, state.q, state.rate);
    for (int i = 0; i < 3; ++i) state.omega[i] = draw.symmetric();
    for (Eigen::Index i = 0; i < state.mix.size(); ++i) state.mix.data()[i] = draw.symmetric();
    return state;
  }

  void add_state(const State& state, const Column& column, const Packed& packed,
                 Eigen::Ref<Eigen::MatrixXd> F) const {
    const auto count = static_cast<Eigen::Index>(column.points.size());
    if (count == 0) return;
    Kinematics all = kinematics(packed, count, state);
    scale_columns(column.points, largest_factors(state), all);
    const Eigen::MatrixXd moved = all.L * state.mix;
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
  Kinematics kinematics(const Packed& packed, Eigen::Index count, const State& state) const {
    const ParameterValues<double> values = shape_.part.parameters().expand<double>(state.q, state.rate);
    const Vec3<double>& omega = state.omega;
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

  /// Returns factors that scale each column of L and the acceleration (last entry) to a root mean square of
  /// 1; infinity for zero columns. points: the mass points of `all`.
  static Eigen::VectorXd unit_factors(const std::vector<RestPoint>& points, const Kinematics& all) {
    double mass = 0;
    for (const RestPoint& p : points) mass += p.mass;
    Eigen::VectorXd factors(all.L.cols() + 1);
    for (Eigen::Index c = 0; c < factors.size(); ++c) {
      double square = 0;
      const auto x = c < all.L.cols() ? Eigen::Ref<const Eigen::VectorXd>(all.L.col(c))
                                      : Eigen::Ref<const Eigen::VectorXd>(all.acceleration);
      // Squares of tiny numbers would underflow.
      const double unit = power_of_two(x.lpNorm<Eigen::Infinity>());
      for (std::size_t k = 0; k < points.size(); ++k)
        square += points[k].mass * (x.segment<3>(3 * static_cast<Eigen::Index>(k)) / unit).squaredNorm();
      factors[c] = square > 0 ? std::sqrt(mass / square) / unit : kInfinity;
    }
    return factors;
  }
  /// Returns the largest factors of scale_columns() in a state: 1e3 times the factors for the whole body.
  /// Without a sample the factors are infinity, because the only Column contains all sections.
  const Eigen::VectorXd& largest_factors(const State& state) const {
    constexpr double share = 1e-3;
    const auto number = static_cast<std::size_t>(state.number);
    if (number >= largest_factors_.size()) largest_factors_.resize(number + 1);
    Eigen::VectorXd& largest = largest_factors_[number];
    if (largest.size() > 0) return largest;
    largest = Eigen::VectorXd::Constant(6 + n() + 1, kInfinity);
    if (!sample_.empty()) {
      const auto count = static_cast<Eigen::Index>(sample_.size());
      largest = unit_factors(sample_, kinematics(pack(sample_, 1), count, state)) / share;
    }
    return largest;
  }
  /// Scales each column of L, and the acceleration, to a root mean square of 1, so that small and large
  /// entries of M have equal weight. A column that is much smaller at these points than over the whole body
  /// is multiplied by its entry of `largest` instead. It has large relative rounding errors and does not
  /// matter for M.
  static void scale_columns(const std::vector<RestPoint>& points, const Eigen::VectorXd& largest,
                            Kinematics& all) {
    const Eigen::VectorXd factors = unit_factors(points, all).cwiseMin(largest);
    for (Eigen::Index c = 0; c < all.L.cols(); ++c)
      if (std::isfinite(factors[c])) all.L.col(c) *= factors[c];
    if (std::isfinite(factors[all.L.cols()])) all.acceleration *= factors[all.L.cols()];
  }

  const RestShape& shape_;
  StateRanges ranges_;
  std::vector<RestPoint> sample_;                         // over the whole body; empty for plane sections
  mutable std::vector<Eigen::VectorXd> largest_factors_;  // of each state; empty until needed
};

/// Returns whether each coordinate plane mirrors the body for all values of the dynamic parameters, from a
/// sample of points and states.
bool planes_mirror(const Part& part) {
  const StateRanges ranges(part);
  Draw draw;
  std::vector<Material<double>> points;
  for (int k = 0; k < 8; ++k)
    points.push_back(material_at(kPi / 2 * draw.uniform(), kPi / 2 * draw.uniform(), draw.uniform()));
  for (int state = 0; state < 8; ++state) {
    VecMax<double> q, rate;
    ranges.draw(draw, state, q, rate);
    const ParameterValues<double> values = part.parameters().expand<double>(q, rate);
    const Eigen::Matrix3Xd s = part.s(points, values);
    for (int i = 0; i < 3; ++i) {
      MirrorSigns signs{1, 1, 1};
      signs[static_cast<std::size_t>(i)] = -1;
      std::vector<Material<double>> images;
      for (const Material<double>& m : points) images.push_back(mirrored(m, signs));
      Eigen::Matrix3Xd back = part.s(images, values);
      back.row(i) *= -1;
      if (!((back - s).norm() <= 1e-12 * s.norm())) return false;
    }
  }
  return true;
}

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

namespace {

/// Returns the moments of order 0, 1 and 2 of masses at rest, kg. Positions are in units of Part::size().
Vec<double, 13> moments_of(const Part& part, const std::vector<Material<double>>& at,
                           const VecX<double>& mass) {
  const Eigen::Matrix3Xd X = part.s(at, part.parameters().rest()) / part.size();
  const Mat3<double> second = X * mass.asDiagonal() * X.transpose();
  Vec<double, 13> moments;
  moments << mass.sum(), X * mass, second.reshaped();
  return moments;
}

/// Returns the difference of the moments of a rule for a mass distribution from those of a grid, relative to
/// the mass. The search for the rule looks at lines through the body, and may miss narrow features.
double difference_from_grid(const Part& part, const std::vector<RestPoint>& points) {
  constexpr int nodes = 14;
  const BodyPoints grid = place_body_points(part, nodes);
  std::vector<Material<double>> at;
  VecX<double> mass(static_cast<Eigen::Index>(points.size()));
  for (const RestPoint& point : points) {
    mass[static_cast<Eigen::Index>(at.size())] = part.density() * point.mass;
    at.push_back(point.at);
  }
  const Vec<double, 13> change = moments_of(part, at, mass) - moments_of(part, grid.at, grid.mass);
  return change.lpNorm<Eigen::Infinity>() / std::max(mass.sum(), grid.mass.sum());
}

/// Returns the mass points of a part. distribution: the mass distribution; nullptr for the same density
/// everywhere.
MassPoints place_points(const Part& part, const MassDistribution* distribution, int doublings) {
  RestShape shape(part, distribution);
  throw_if_folded(part, shape.rest, "rest");
  if (part.n_s() > 0) throw_if_folded(part, initial_values(part), "initial");
  shape.octant = distribution == nullptr && shape.points_apart && octant_panels(shape) && planes_mirror(part);
  const MassIntegrands integrands(shape);
  const bool affine = shape.follows == Follows::affine;
  PlacedPoints placed = shape.by_sections ? place_slices(shape, integrands, 2 * doublings)
                                          : RingSearch(shape, integrands, !affine, 2 * doublings).run();
  // A difference below this value may be the error of the grid.
  constexpr double from_grid = 1e-7;
  if (const double difference = distribution == nullptr ? 0 : difference_from_grid(part, placed.points);
      difference > from_grid)
    placed.remaining = std::max(placed.remaining, difference);
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

}  // namespace

MassPoints place_mass_points(const Part& part, int doublings) {
  return place_points(part, part.mass_distribution(), doublings);
}

double volume_at_rest(const Part& part) {
  double mass = 0;
  for (const Pack& four : place_points(part, nullptr, 0).mass)
    for (int i = 0; i < Pack::kLanes; ++i) mass += four[i];
  return mass / part.density();
}

}  // namespace pliant
