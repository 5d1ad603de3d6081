// Chain<Taper, Bend>: a chain of global deformations, T of Eq. (3), whose type fixes the order of the links.
// Scenes use AnyChain (any_chain.h) instead.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <pliant/deform/link.h>

namespace pliant {

/// The properties of a link, independent of its type.
struct LinkInfo {
  const char* type;  ///< name of the deformation
  const ParameterSpec* parameters;
  int n_parameters;
  int amplitudes;  ///< if the first `amplitudes` parameters have their defaults, the link is the identity
  Sections sections;
};

/// Returns the properties of a link.
template <class Deform>
LinkInfo link_info() {
  return {Deform::name, Deform::parameters.data(), deform_size<Deform>, deform_amplitudes<Deform>,
          Deform::sections};
}

/// Returns the position (m, body frame) whose image under one link is p. h: half height (m); b: parameters of
/// the link.
template <class Deform>
Vec3<double> link_inverse(const Vec3<double>& p, double h, const double* b) {
  if (is_identity<Deform>(b)) return p;
  const Eigen::Map<const Vec<double, deform_size<Deform>>> parameters(b);
  return Deform::template inverse<double>(p, h, parameters);
}

/// A chain of links that are applied in the order of the template arguments.
template <class... Links>
class Chain {
 public:
  /// Returns the properties of the links, in order.
  std::vector<LinkInfo> links() const { return {link_info<Links>()...}; }

  /// Returns whether any link acts. A link acts if it is not the identity or one of its parameters is
  /// dynamic. all: the parameters of all links, one link after the other.
  template <class P>
  bool acts([[maybe_unused]] LinkParameters<P> all) const {
    return (one_acts<Links>(all) || ...);
  }
  /// Applies all links in order to a batch of jets. half: half height of the shape; all: the parameters of
  /// all links, one link after the other.
  template <class P, class S>
  void apply([[maybe_unused]] const HalfHeight<P>& half, [[maybe_unused]] LinkParameters<P> all,
             [[maybe_unused]] JetBatch<S>& batch) const {
    (apply_one<Links>(half, all, batch), ...);
  }

  /// Returns the position e (m, body frame) whose image under the chain is p. h: half height (m); b: the
  /// parameters of all links, one link after the other.
  Vec3<double> inverse(Vec3<double> p, double h, const double* b) const {
    const double* end = b + (0 + ... + deform_size<Links>);
    invert<Links...>(p, h, end);
    return p;
  }

 private:
  template <class Link, class P>
  static bool one_acts(LinkParameters<P>& next) {
    const LinkParameters<P> own = next;
    next.b += deform_size<Link>;
    next.b_dot += deform_size<Link>;
    next.dynamic += deform_size<Link>;
    return link_acts<Link>(own);
  }
  template <class Link, class P, class S>
  static void apply_one(const HalfHeight<P>& half, LinkParameters<P>& next, JetBatch<S>& batch) {
    apply_link<Link>(half, next, batch);
    next.b += deform_size<Link>;
    next.b_dot += deform_size<Link>;
    next.dynamic += deform_size<Link>;
  }
  template <class... None>
  static std::enable_if_t<sizeof...(None) == 0> invert(Vec3<double>&, double, const double*&) {}
  template <class First, class... Rest>
  static void invert(Vec3<double>& p, double h, const double*& end) {
    invert<Rest...>(p, h, end);
    end -= deform_size<First>;
    p = link_inverse<First>(p, h, end);
  }
};

}  // namespace pliant
