// The placement of quadrature points for the strain energy.
#include <pliant/part/quadrature/strain_rule.h>

#include <cmath>
#include <sstream>

#include <Eigen/LU>

#include <pliant/part/strain.h>

#include "rule_search.h"

namespace pliant {

using namespace rule_search;

namespace {

/// Material points with their derivatives along three directions.
using TangentPoints = std::vector<Material<Dual<3>>>;

/// Changes the directions of the derivatives of a material point. The columns of from_X are the new
/// directions, in components along the old directions.
void change_directions(Material<Dual<3>>& m, const Mat3<double>& from_X) {
  auto change = [&](Dual<3>& x) {
    const Eigen::RowVector3d d = Eigen::RowVector3d(x.d[0], x.d[1], x.d[2]) * from_X;
    for (std::size_t r = 0; r < 3; ++r) x.d[r] = d[static_cast<Eigen::Index>(r)];
  };
  for (Trig<Dual<3>>* t : {&m.cu, &m.su, &m.cv, &m.sv}) {
    change(t->x);
    change(t->log_abs);
  }
  change(m.w);
}

/// Returns the directions in (u, v, w) (columns) of unit steps in the rest body: along x, y and z for a
/// solid, along two orthonormal tangents for a shell (third column zero). at_rest: [s_u s_v s_w] at rest.
Mat3<double> material_directions(const Mat3<double>& at_rest, bool shell) {
  if (!shell) return at_rest.inverse();
  Mat3<double> from_X = Mat3<double>::Zero();
  const Eigen::Matrix<double, 3, 2> surface = at_rest.leftCols<2>();
  const Vec3<double> first = surface.col(0).normalized();
  Eigen::Matrix<double, 3, 2> frame;
  frame << first, (surface.col(1) - first * first.dot(surface.col(1))).normalized();
  from_X.topLeftCorner<2, 2>() = Eigen::Matrix2d(frame.transpose() * surface).inverse();
  return from_X;
}

/// Returns the points with their derivatives along the directions X of the rest body (StrainPoints).
TangentPoints with_derivatives(const Part& part, const ParameterValues<double>& rest,
                               const std::vector<RestPoint>& points) {
  const std::size_t n = points.size();
  Eigen::Matrix3Xd e(3, static_cast<Eigen::Index>(n));
  std::vector<Mat3<double>> tangents(n);
  TangentPoints moving(n);
  for (std::size_t k = 0; k < n; ++k) {
    moving[k] = material_with_tangents(points[k].at);
    const Vec3<Dual<3>> at = part.shape().tangents(moving[k], rest.b.data());
    for (int i = 0; i < 3; ++i) {
      e(i, static_cast<Eigen::Index>(k)) = at[i].v;
      for (int j = 0; j < 3; ++j) tangents[k](i, j) = at[i].d[static_cast<std::size_t>(j)];
    }
  }
  const std::vector<Mat3<double>> F = part.chain_gradient(e, rest);
  for (std::size_t k = 0; k < n; ++k)
    change_directions(moving[k], material_directions(F[k] * tangents[k], part.shell()));
  return moving;
}

/// Returns the points in packs of four, with their derivatives along the directions X of the rest body.
StrainPoints with_directions(const Part& part, const ParameterValues<double>& rest,
                             const std::vector<RestPoint>& points) {
  const std::size_t n = points.size();
  StrainPoints out;
  out.n_points = static_cast<int>(n);
  out.directions = part.shell() ? 2 : 3;
  const TangentPoints moving = with_derivatives(part, rest, points);
  for (std::size_t first = 0; first < n; first += Pack::kLanes) {
    std::array<Material<Dual<3>>, Pack::kLanes> four;
    Pack weight(0.0);
    for (std::size_t i = 0; i < Pack::kLanes; ++i) {
      four[i] = moving[std::min(first + i, n - 1)];
      if (first + i < n) weight.set(static_cast<int>(i), points[first + i].mass);
    }
    for (std::size_t r = 0; r < static_cast<std::size_t>(out.directions); ++r)
      out.at[r].push_back(gather(four.data(), r));
    out.weight.push_back(weight);
  }
  return out;
}

/// The integrands of a state: energy, force and stiffness along random directions, and the volume. Each
/// integrand is divided by its root mean square over the body, so that soft and stiff states have equal
/// weight.
class StrainIntegrands {
 public:
  static constexpr const char* subject = "strain energy";
  static constexpr int kEach = 4;
  static constexpr double kTolerance = kStrainTolerance, kRequired = 1e2 * kStrainTolerance;
  static constexpr int last_level() { return kLastLevel; }

  StrainIntegrands(const RestShape& shape, const ContinuumLaw& law)
      : shape_(shape), law_(law), ranges_(shape.part) {
    constexpr int coarse = 4;
    const std::vector<AngleNode> v = ring_nodes(shape, coarse);
    for (const AngleNode& u : profile_nodes(shape, coarse))
      for (const QuadratureNode& w : depth_nodes(shape, coarse)) add_ring(shape, u, w, v, sample_);
    sample_points_ = with_directions(shape.part, shape.rest, sample_);
  }
  int n_states() const { return ranges_.n() == 0 ? 8 : 48; }
  static Thinning thinning() { return {1e-2 * kStrainTolerance}; }

  Eigen::MatrixXd shares(const Columns& line, int first, int end) const {
    Eigen::MatrixXd F = Eigen::MatrixXd::Zero(line.n_nodes, kEach * (end - first));
    Draw draw;
    std::vector<StrainPoints> points;
    for (const Column& column : line.columns)
      points.push_back(with_directions(shape_.part, shape_.rest, column.points));
    for (int number = 0; number < end; ++number) {
      State state;
      ranges_.draw(draw, number, state.q, state.first);
      confine(number, state.q);
      VecMax<double> unused;
      ranges_.draw(draw, number, unused, state.second);
      if (number < first) continue;
      const Densities& unit = units(number, state);
      const std::size_t place = static_cast<std::size_t>(number) % line.columns.size();
      const Column& column = line.columns[place];
      for_each_point(points[place], column.points.size(), state,
                     [&](std::size_t k, const Densities& density) {
                       for (std::size_t c = 0; c < kEach; ++c)
                         F(column.node[k], kEach * (number - first) + static_cast<int>(c)) +=
                             column.points[k].mass * density[c] / unit[c];
                     });
    }
    return F;
  }

 private:
  using Densities = std::array<double, kEach>;
  struct State {
    VecMax<double> q, first, second;
  };

  /// If the law has no energy for inverted material, moves a state towards the rest shape until det F is at
  /// least 0.3 at all sample points.
  void confine(int number, VecMax<double>& q) const {
    if (!std::holds_alternative<Damped<NeoHookeanLog>>(law_)) return;
    constexpr double least = 0.3;  // smallest det F that is accepted
    const int n = static_cast<int>(q.size());
    const auto rest = [&](int k) { return shape_.part.parameters().moving(k).rest_value(); };
    if (static_cast<std::size_t>(number) == reach_.size()) {
      VecMax<double> trial(n);
      double reach = 2;
      do {
        reach /= 2;
        for (int k = 0; k < n; ++k) trial[k] = rest(k) + reach * (q[k] - rest(k));
      } while (!(least_volume(trial) >= least));
      reach_.push_back(reach);
    }
    const double reach = reach_[static_cast<std::size_t>(number)];
    for (int k = 0; k < n; ++k) q[k] = rest(k) + reach * (q[k] - rest(k));
  }

  /// Returns the smallest det F at the sample points.
  double least_volume(const VecMax<double>& q) const {
    const auto values =
        shape_.part.parameters().expand<Dual<1>>(q, VecMax<double>(VecMax<double>::Zero(q.size())));
    const int packs = static_cast<int>(sample_points_.weight.size());
    double least = kInfinity;
    strain::Block block;
    for (int begin = 0; begin < packs; begin += strain::kBlock) {
      const int count = std::min(strain::kBlock, packs - begin);
      strain::evaluate({shape_.part, values, sample_points_, begin, count}, static_cast<int>(q.size()),
                       Level::position, block);
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
        least = std::min(least, min_lane(determinant(block.F[i], cofactors(block.F[i]))));
    }
    return least;
  }

  /// Calls act(number, densities) for the first n points.
  template <class Act>
  void for_each_point(const StrainPoints& points, std::size_t n, const State& state, Act&& act) const {
    const auto values = shape_.part.parameters().expand<Dual<1>>(
        state.q, VecMax<double>(VecMax<double>::Zero(state.q.size())));
    const int packs = static_cast<int>(points.weight.size()), n_s = static_cast<int>(state.q.size());
    strain::Block block;
    for (int begin = 0; begin < packs; begin += strain::kBlock) {
      const int count = std::min(strain::kBlock, packs - begin);
      strain::evaluate({shape_.part, values, points, begin, count}, n_s, Level::jacobian, block);
      for (int i = 0; i < count; ++i) {
        const std::array<Pack, kEach> four =
            densities(block.F[static_cast<std::size_t>(i)], block.dF[static_cast<std::size_t>(i)], state);
        for (int lane = 0; lane < Pack::kLanes; ++lane) {
          const std::size_t k = static_cast<std::size_t>((begin + i) * Pack::kLanes + lane);
          if (k < n) act(k, Densities{four[0][lane], four[1][lane], four[2][lane], four[3][lane]});
        }
      }
    }
  }

  /// Returns the integrands at four points.
  std::array<Pack, kEach> densities(const Mat3<Pack>& F, const std::array<Mat3<Pack>, kMaxGlobal>& by_q,
                                    const State& state) const {
    const Mat3<Pack> dF = strain::combine(by_q, state.first), second_dF = strain::combine(by_q, state.second);
    Mat3<Dual<1, Pack>> along;
    for (int c = 0; c < 9; ++c) {
      along.data()[c] = Dual<1, Pack>(F.data()[c]);
      along.data()[c].d[0] = dF.data()[c];
    }
    return std::visit(
        [&](const auto& law) -> std::array<Pack, kEach> {
          const Mat3<Dual<1, Pack>> P = law.stress(along);
          Pack force(0.0), stiffness(0.0);
          for (int c = 0; c < 9; ++c) {
            force += P.data()[c].v * dF.data()[c];
            stiffness += P.data()[c].d[0] * second_dF.data()[c];
          }
          return {law.density(F), force, stiffness, Pack(1.0)};
        },
        law_);
  }

  /// Returns the root mean squares of the integrands over the body in state `number`. The result is infinity
  /// for an energy or a force whose root mean square is at most 1e-10 times that of the stiffness.
  const Densities& units(int number, const State& state) const {
    const auto known = units_.size();
    if (static_cast<std::size_t>(number) < known) return units_[static_cast<std::size_t>(number)];
    Densities squares{};
    double mass = 0;
    for_each_point(sample_points_, sample_.size(), state, [&](std::size_t k, const Densities& density) {
      mass += sample_[k].mass;
      for (std::size_t c = 0; c < kEach; ++c) squares[c] += sample_[k].mass * density[c] * density[c];
    });
    constexpr double noise = 1e-10;
    constexpr std::size_t stiffness = 2, volume = 3;
    const double min_square = noise * noise * squares[stiffness];
    for (std::size_t c = 0; c < kEach; ++c)
      squares[c] = squares[c] > (c == volume ? 0 : min_square) ? std::sqrt(squares[c] / mass) : kInfinity;
    units_.push_back(squares);
    return units_.back();
  }

  const RestShape& shape_;
  const ContinuumLaw& law_;
  StateRanges ranges_;
  std::vector<RestPoint> sample_;  // over the whole body
  StrainPoints sample_points_;
  mutable std::vector<Densities> units_;  // of each state, in the order in which they are drawn
  mutable std::vector<double> reach_;     // of each state: factor by which confine() scales q - rest
};

/// Removes points that the integrals do not need. Each pass handles the points in groups; the passes end when
/// a pass removes at most a quarter of the points.
void thin_points(const StrainIntegrands& integrands, std::vector<RestPoint>& points) {
  constexpr std::size_t group = 400;
  struct Weighted {
    RestPoint point;
    double weight = 1;
  };
  for (std::size_t before = 2 * points.size(); 4 * points.size() < 3 * before;) {
    before = points.size();
    std::vector<RestPoint> kept;
    for (std::size_t first = 0; first < before; first += group) {
      Columns line;
      line.columns.emplace_back();
      std::vector<Weighted> nodes;
      for (std::size_t k = first; k < std::min(first + group, before); ++k) {
        line.columns[0].points.push_back(points[k]);
        line.columns[0].node.push_back(line.n_nodes++);
        nodes.push_back({points[k]});
      }
      thin(integrands, line, nodes);
      for (const Weighted& node : nodes) kept.push_back({node.point.at, node.weight * node.point.mass});
    }
    points = std::move(kept);
  }
}

/// Returns the names of the dynamic parameters.
std::string dynamic_names(const Part& part) {
  std::string names;
  for (int i : part.parameters().dynamic()) names += (names.empty() ? "" : ", ") + part.parameters()[i].name;
  return names;
}

}  // namespace

StrainPoints place_strain_points(const Part& part, const ContinuumLaw& law, double volume) {
  RestShape shape(part);
  if (shape.follows == Follows::affine && !part.shell()) {
    // The strain is equal everywhere, so that one point represents the body.
    StrainPoints one = with_directions(part, shape.rest, {{material_at(0.4, 0.7, 0.5), volume}});
    one.rule = "affine";
    return one;
  }
  shape.by_sections = false;
  shape.points_apart = true;
  const StrainIntegrands integrands(shape, law);
  PlacedPoints placed = RingSearch(shape, integrands, true, 0).run();
  if (placed.remaining > StrainIntegrands::kRequired || !std::isfinite(placed.remaining)) {
    std::ostringstream message;
    message << "part '" << part.name()
            << "': the quadrature of its strain energy does not converge over the ranges of "
            << dynamic_names(part)
            << " (doubling the rule changes energy, force or stiffness by a relative amount of "
            << placed.remaining << "); freeze some of them, or narrow their limits (min, max)";
    throw std::invalid_argument(message.str());
  }
  remove_massless(placed.points);
  thin_points(integrands, placed.points);
  StrainPoints points = with_directions(part, shape.rest, placed.points);
  points.rule = "rings";
  points.relative_error = std::max(placed.remaining, kStrainTolerance);
  return points;
}

}  // namespace pliant
