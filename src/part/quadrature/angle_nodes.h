// Nodes of quadrature rules along a material angle: u or v.
#pragma once

#include <vector>

#include <pliant/math/scalar/dual.h>
#include <pliant/math/scalar/signed_power.h>
#include <pliant/shape/panel.h>

namespace pliant {

/// A node along a material angle: cosine and sine with their derivatives by the variable of the rule.
struct AngleNode {
  Trig<Dual<1>> c, s;
  double weight;
};

/// The region of a quadrant of an angle in which integrands with dynamic exponents vary fastest, in terms of
/// the variable y = log |tan|. The interval [from, to] contains the kinks for all values of the exponents.
/// `width` is the distance of the nearest complex singularity from a kink.
struct Kinks {
  double from = 0, to = 0, width = kPi / 2;
};

/// Returns the nodes of panels with fixed exponents: n in each panel, but 2 n in a periodic panel.
std::vector<AngleNode> angle_nodes(const std::vector<Panel>& panels, int n);
/// Returns the nodes of panels if an exponent is a degree of freedom: n in each panel, but 2 n in a periodic
/// panel. If kinks.from and kinks.to differ, each quadrant has n further nodes between them.
std::vector<AngleNode> angle_nodes(const std::vector<Panel>& panels, int n, const Kinks& kinks);

}  // namespace pliant
