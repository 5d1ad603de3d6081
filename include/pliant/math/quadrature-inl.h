// Gauss-Legendre rules and their graded variants for end-point singularities.
#pragma once

#include <pliant/math/quadrature.h>

#include <cmath>
#include <cstddef>
#include <map>
#include <mutex>

#include <pliant/math/header_only.h>
#include <pliant/math/scalar/functions.h>

namespace pliant {

namespace detail {

inline std::vector<QuadratureNode> make_gauss_rule(int n) {
  std::vector<QuadratureNode> rule(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    // Newton iteration for a root of the Legendre polynomial P_n, from the usual cosine estimate.
    double x = std::cos(kPi * (i + 0.75) / (n + 0.5)), slope = 1;
    for (int iteration = 0; iteration < 20; ++iteration) {
      double before = 1, p = x;
      for (int k = 2; k <= n; ++k) {
        const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p;
        p = next;
      }
      slope = n * (x * p - before) / (x * x - 1);
      const double dx = p / slope;
      x -= dx;
      if (std::abs(dx) < 1e-16) break;
    }
    // Roots descend in [-1, 1]; x ascends in [0, 1].
    rule[static_cast<std::size_t>(i)] = {(1 - x) / 2, (1 + x) / 2, 1 / ((1 - x * x) * slope * slope)};
  }
  return rule;
}

}  // namespace detail

PLIANT_INLINE std::vector<QuadratureNode> gauss_rule(int n) {
  // The rules are cached, because loading a scene needs a few rules many times.
  static std::mutex busy;
  static std::map<int, std::vector<QuadratureNode>> made;
  const std::lock_guard<std::mutex> lock(busy);
  std::vector<QuadratureNode>& rule = made[n];
  if (rule.empty()) rule = detail::make_gauss_rule(n);
  return rule;
}

PLIANT_INLINE std::vector<QuadratureNode> one_end_rule(int n, double q) {
  std::vector<QuadratureNode> rule = gauss_rule(n);
  for (QuadratureNode& node : rule) {
    const double y = node.x;
    node.x = std::pow(y, q);
    node.gap = -std::expm1(q * std::log1p(-node.gap));
    node.weight *= q * node.x / y;
  }
  return rule;
}

PLIANT_INLINE std::vector<QuadratureNode> both_ends_rule(int n) {
  std::vector<QuadratureNode> rule;
  const std::vector<QuadratureNode> half = one_end_rule(n);
  for (const QuadratureNode& node : half) rule.push_back({node.x / 2, 1 - node.x / 2, node.weight / 2});
  for (auto node = half.rbegin(); node != half.rend(); ++node)
    rule.push_back({1 - node->x / 2, node->x / 2, node->weight / 2});
  return rule;
}

}  // namespace pliant
