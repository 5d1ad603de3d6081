// Nodes along a material angle, panel by panel.
#include "angle_nodes.h"

#include <cmath>

#include <pliant/math/quadrature.h>

namespace pliant {

namespace {

/// Returns a sine or cosine from the logarithm of its absolute value, the derivative of this logarithm, and
/// the sign. The derivative of the logarithm is finite where the value underflows.
Trig<Dual<1>> from_log(double log_abs, double log_slope, double sign) {
  const double value = sign * std::exp(log_abs);
  Trig<Dual<1>> t{Dual<1>(value), Dual<1>(sign), Dual<1>(log_abs)};
  t.x.d[0] = value * log_slope;
  t.log_abs.d[0] = log_slope;
  return t;
}
/// Returns a sine or cosine with its derivative.
Trig<Dual<1>> with_slope(double value, double slope) {
  const Trig<double> t = trig(value);
  Trig<Dual<1>> r{Dual<1>(value), Dual<1>(t.sign), Dual<1>(t.log_abs)};
  r.x.d[0] = slope;
  r.log_abs.d[0] = value != 0 ? slope / value : 0;
  return r;
}

/// Adds m equidistant nodes of a periodic panel to `nodes`.
void add_periodic_nodes(const Panel& panel, int m, std::vector<AngleNode>& nodes) {
  for (int i = 0; i < m; ++i) {
    const double angle = panel.from + (panel.to - panel.from) * (i + 0.5) / m;
    const double c = std::cos(angle), s = std::sin(angle);
    nodes.push_back({with_slope(c, -s), with_slope(s, c), (panel.to - panel.from) / m});
  }
}

/// Adds n Gauss nodes of a panel on which the shape is smooth in the angle to `nodes`.
void add_smooth_nodes(const Panel& panel, int n, std::vector<AngleNode>& nodes) {
  for (const QuadratureNode& node : gauss_rule(n)) {
    const double angle = panel.from + (panel.to - panel.from) * node.x;
    const double c = std::cos(angle), s = std::sin(angle);
    nodes.push_back({with_slope(c, -s), with_slope(s, c), (panel.to - panel.from) * node.weight});
  }
}

/// A panel from a coordinate axis to 45 degrees, with the variable t = |near|^eps in [0, 2^(-eps/2)]. `near`
/// is the sine or cosine that vanishes at the axis, and `far` is the other function.
class PowerPanel {
 public:
  PowerPanel(const Panel& panel, std::vector<AngleNode>& nodes) : panel_(panel), nodes_(nodes) {}

  /// Adds n nodes. The integrand consists of powers of t and of t^(2/eps). With t = x^q and q a multiple of
  /// eps, the powers of t^(2/eps) are smooth in x; with q >= 4 the powers of t are smooth enough.
  void add(int n) {
    const double reach = std::exp2(-panel_.eps / 2);
    for (const QuadratureNode& node : one_end_rule(n, panel_.eps * std::ceil(4 / panel_.eps)))
      add(std::log(reach * node.x) / panel_.eps, reach * node.weight);
  }

 private:
  void add(double log_near, double weight) {
    const double near2 = std::exp(2 * log_near), far2 = -std::expm1(2 * log_near);
    const double log_near_slope = std::exp(-panel_.eps * log_near) / panel_.eps;  // 1 / (eps t)
    const double log_far_slope = -near2 * log_near_slope / far2;
    const double sign_near = panel_.along_sin ? panel_.sign_sin : panel_.sign_cos;
    const double sign_far = panel_.along_sin ? panel_.sign_cos : panel_.sign_sin;
    const Trig<Dual<1>> near = from_log(log_near, log_near_slope, sign_near);
    const Trig<Dual<1>> far = from_log(0.5 * std::log(far2), log_far_slope, sign_far);
    nodes_.push_back(panel_.along_sin ? AngleNode{far, near, weight} : AngleNode{near, far, weight});
  }

  const Panel& panel_;
  std::vector<AngleNode>& nodes_;
};

/// A panel from a coordinate axis to the kinks, with the variable y = log |tan|. For dynamic exponents the
/// integrand consists of powers |sin|^p and |cos|^p with many different p. These powers are exponentials in y
/// with many decay rates.
class LogPanel {
 public:
  LogPanel(const Panel& panel, const Kinks& kinks, std::vector<AngleNode>& nodes)
      : panel_(panel), kinks_(kinks), nodes_(nodes) {}

  /// Adds n nodes. The density of nodes decreases with the distance d from the kinks as 1 / (width + d), so
  /// that the rule resolves the kinks and every decay rate. `near` is the sine or cosine that vanishes at the
  /// axis. The rule ends where |near|^eps, a factor of the mass, is e^-37, a rounding error relative to 1.
  void add(int n) {
    const double stretch = std::log1p(37 / (panel_.eps * kinks_.width));
    for (const QuadratureNode& node : gauss_rule(n)) {
      const double d = kinks_.width * std::expm1(stretch * node.x);
      const double weight = (kinks_.width + d) * stretch * node.weight;
      add(panel_.along_sin ? kinks_.from - d : kinks_.to + d, weight);
    }
    const double between = kinks_.to - kinks_.from;
    if (!panel_.along_sin || between == 0) return;
    for (const QuadratureNode& node : gauss_rule(n))
      add(kinks_.from + between * node.x, between * node.weight);
  }

 private:
  void add(double y, double weight) {
    // log |cos| = -1/2 log(1 + e^2y), log |sin| = -1/2 log(1 + e^-2y)
    const double cos2 = 1 / (1 + std::exp(2 * y)), sin2 = 1 / (1 + std::exp(-2 * y));
    const double log_larger = -0.5 * std::log1p(std::exp(-2 * std::abs(y)));
    const double log_cos = y > 0 ? log_larger - y : log_larger, log_sin = y > 0 ? log_larger : log_larger + y;
    nodes_.push_back(
        {from_log(log_cos, -sin2, panel_.sign_cos), from_log(log_sin, cos2, panel_.sign_sin), weight});
  }

  const Panel& panel_;
  const Kinks& kinks_;
  std::vector<AngleNode>& nodes_;
};

/// Returns the nodes of panels. add_power(panel, nodes) adds the nodes of a power panel.
template <class AddPower>
std::vector<AngleNode> nodes_of(const std::vector<Panel>& panels, int n, const AddPower& add_power) {
  std::vector<AngleNode> nodes;
  for (const Panel& panel : panels) {
    if (panel.kind == Panel::Kind::periodic)
      add_periodic_nodes(panel, 2 * n, nodes);
    else if (panel.kind == Panel::Kind::smooth)
      add_smooth_nodes(panel, n, nodes);
    else
      add_power(panel, nodes);
  }
  return nodes;
}

}  // namespace

std::vector<AngleNode> angle_nodes(const std::vector<Panel>& panels, int n) {
  return nodes_of(panels, n, [n](const Panel& panel, std::vector<AngleNode>& nodes) {
    // With a small exponent the superellipse is nearly a square, and varies only next to the corner, at 45
    // degrees. A LogPanel has its densest nodes there.
    constexpr double small = 0.25;
    if (panel.eps < small)
      LogPanel(panel, Kinks(), nodes).add(n);
    else
      PowerPanel(panel, nodes).add(n);
  });
}

std::vector<AngleNode> angle_nodes(const std::vector<Panel>& panels, int n, const Kinks& kinks) {
  return nodes_of(panels, n, [&](const Panel& panel, std::vector<AngleNode>& nodes) {
    LogPanel(panel, kinks, nodes).add(n);
  });
}

}  // namespace pliant
