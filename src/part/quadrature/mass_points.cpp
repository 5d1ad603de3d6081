// Laying mass points, by the integrands of M and g_q.
#include <pliant/part/quadrature/mass_points.h>

#include <Eigen/Cholesky>

#include "rule_search.h"

namespace pliant {

using namespace rule_search;

namespace {

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

/// Integrands of the mass matrix and of the inertial forces: (La).(Lb) and (La).(acceleration at vdot = 0),
/// for random combinations a, b of generalised velocities at random states.
class MassIntegrands {
 public:
  static constexpr const char* what = "mass matrix";
  static constexpr int kEach = 3;
  static constexpr double kSettled = 2e-14, kThin = 1e-15;
  static constexpr double kPromised = 1e-12;  ///< of every rule (design 1.3)

  explicit MassIntegrands(const RestShape& shape) : shape_(shape), ranges_(shape.part) {}
  int n() const { return ranges_.n(); }

  /// F(node, function): the shares of the nodes of one direction in each integral.
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
    for (int i = 0; i < 3; ++i) omega[i] = draw.either_way();
    Eigen::MatrixXd mix(6 + n(), kEach + 2);
    for (Eigen::Index i = 0; i < mix.size(); ++i) mix.data()[i] = draw.either_way();

    // L of every point, three rows each, and the acceleration.
    const auto count = static_cast<Eigen::Index>(column.points.size());
    if (count == 0) return;
    Eigen::MatrixXd L(3 * count, 6 + n());
    Eigen::VectorXd acceleration(3 * count);
    const ParameterValues<double> values = shape_.part.parameters().expand<double>(q, rate);
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
        auto rows = L.middleRows<3>(3 * point);
        rows.leftCols<3>().setIdentity();
        for (int i = 0; i < 3; ++i) rows.col(3 + i) = Vec3<double>::Unit(i).cross(s);
        for (int i = 0; i < n(); ++i) rows.col(6 + i) = one(jet.J[static_cast<std::size_t>(i)]);
        acceleration.segment<3>(3 * point) =
            omega.cross(omega.cross(s)) + 2 * omega.cross(one(jet.s1)) + one(jet.s2);
      }
    }
    // Each column in units of its own spread, so that small entries of M count as much as large ones.
    double mass = 0;
    for (const RestPoint& p : column.points) mass += p.mass;
    if (!(mass > 0)) return;
    for (Eigen::Index c = 0; c < L.cols() + 1; ++c) {
      double square = 0;
      auto x =
          c < L.cols() ? Eigen::Ref<Eigen::VectorXd>(L.col(c)) : Eigen::Ref<Eigen::VectorXd>(acceleration);
      for (Eigen::Index k = 0; k < count; ++k)
        square += column.points[static_cast<std::size_t>(k)].mass * x.segment<3>(3 * k).squaredNorm();
      if (square > 0) x *= std::sqrt(mass / square);
    }
    const Eigen::MatrixXd moved = L * mix;
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto index = static_cast<std::size_t>(k);
      const double m = column.points[index].mass;
      const auto at = moved.middleRows<3>(3 * k);
      F(column.node[index], 0) += m * at.col(0).dot(at.col(1));
      F(column.node[index], 1) += m * at.col(2).dot(at.col(3));
      F(column.node[index], 2) += m * at.col(4).dot(acceleration.segment<3>(3 * k));
    }
  }

  const RestShape& shape_;
  StateRanges ranges_;
};

ParameterValues<double> initial_values(const Part& part) {
  const Parameters& all = part.parameters();
  VecMax<double> q_s(all.n_dynamic()), still = VecMax<double>::Zero(all.n_dynamic());
  for (int k = 0; k < all.n_dynamic(); ++k) q_s[k] = all.moving(k).initial;
  return all.expand<double>(q_s, still);
}

Laid lay_slices(const RestShape& shape, const MassIntegrands& integrands, int extra) {
  auto columns = [&](const std::vector<SliceNode>& nodes) {
    Columns line{{Column{}}, 0};
    for (const SliceNode& node : nodes) {
      add_slice(shape, node, line.columns[0].points);
      line.columns[0].end_node(line.n_nodes++);
    }
    return line;
  };
  Laid laid;
  laid.level =
      settle(integrands, laid.left, [&](int level) { return columns(slice_nodes(shape, size_at(level))); });
  std::vector<SliceNode> nodes = slice_nodes(shape, size_at(laid.level + extra));
  if (shape.follows != Follows::affine) thin(integrands, columns(nodes), nodes);
  for (const SliceNode& node : nodes) add_slice(shape, node, laid.points);
  return laid;
}

/// The same mass, centroid and second moments on four points.
std::vector<RestPoint> affine_points(const RestShape& r, const std::vector<RestPoint>& points) {
  const ShapeFace& shape = r.part.shape();
  double m = 0;
  Vec3<double> first = Vec3<double>::Zero();
  Mat3<double> second = Mat3<double>::Zero();
  for (const RestPoint& p : points) {
    const Vec3<double> e = shape.e(p.at, r.a);
    m += p.mass;
    first += p.mass * e;
    second += p.mass * e * e.transpose();
  }
  // What symmetry makes zero is set to zero: in slender bodies its rounding would couple parameters that are
  // not coupled.
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
  Laid laid = shape.by_sections ? lay_slices(shape, integrands, 2 * doublings)
                                : lay_rings(shape, integrands, !affine, 2 * doublings);
  if (affine) laid.points = affine_points(shape, laid.points);
  laid.points.erase(std::remove_if(laid.points.begin(), laid.points.end(),
                                   [](const RestPoint& p) { return !(p.mass > 0); }),
                    laid.points.end());
  Packed packed = pack(laid.points, part.density());
  MassPoints out;
  out.at = std::move(packed.at);
  out.mass = std::move(packed.mass);
  out.n_points = static_cast<int>(laid.points.size());
  out.rule = affine ? "affine" : shape.by_sections ? "sections" : shape.points_apart ? "full" : "rings";
  out.level = laid.level;
  out.unsettled = laid.left;
  return out;
}

}  // namespace pliant
