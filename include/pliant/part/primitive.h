// Primitive<Shape, GlobalDeform>: the class of a part, Eq. (3),
//   s = T(e(u; a); b)
// Shape gives e, a solid primitive with parameters a (include/pliant/shape). GlobalDeform gives T, a chain of
// taper, twist, bend, shear, ... with parameters b (include/pliant/deform). e and T are formulas. Dual
// numbers and Taylor numbers give the derivatives: J = ds/dq_s of Eq. (9), J qs_dot of Eq. (7), and Jdot
// qs_dot, a term of g_q in Eq. (11). Primitive evaluates s, J and the rates for batches of material points.
// All other code is in Part, which does not depend on the types Shape and GlobalDeform.
//
//   Primitive<Superellipsoid, Chain<Taper, Bend>> body("body", 1000);   // 1000 kg/m^3
//   body.place({0, 0, 1}).rest({{"a3", 2.0}}).stiffness({{"bend.angle", 50.0}});
//
// Scenes choose the chain at run time: their parts are Primitive<Shape, AnyChain>, made by make_part()
// (registry.h).
#pragma once

#include <memory>
#include <string>
#include <utility>

#include <pliant/deform/any_chain.h>
#include <pliant/part/instances/kernel_instances.h>
#include <pliant/part/part.h>

namespace pliant {

template <class Shape, class GlobalDeform = Chain<>>
class Primitive final : public Part {
 public:
  /// density: kg/m^3 of a solid, kg/m^2 of a shell.
  explicit Primitive(std::string name, double density = 1000, GlobalDeform chain = {})
      : Part(std::move(name), density, std::make_unique<ShapeInterfaceOf<Shape>>(), chain.links()),
        chain_(std::move(chain)) {}

  /// Evaluates s, J, J q_s_dot and Jdot q_s_dot of a batch of material points at given values of all
  /// parameters.
  void jets(const ParameterValues<double>& values, const Material<Pack>* at,
            JetBatch<Pack>& batch) const override {
    evaluate(values, at, batch);
  }
  /// Evaluates the jets with their derivatives along the direction of the dual parts of the arguments.
  void jets(const ParameterValues<Dual<1>>& values, const Material<Dual<1, Pack>>* at,
            JetBatch<Dual<1, Pack>>& batch) const override {
    evaluate(values, at, batch);
  }
  using Part::jets;

 private:
  template <class P, class S>
  void evaluate(const ParameterValues<P>& values, const Material<S>* at, JetBatch<S>& batch) const {
    const LinkParameters<P> all{values.b.data(), values.b_dot.data(), parameters().dynamic_flags()};
    shape_jets<Shape>(all, at, batch);  // e(u; a) and de/da
    // x = T(e; b), link by link: J <- [F J + T_h dh/da, G_T] (deform/link.h).
    if (chain_.acts(chain_part(all))) chain_.apply(half_height_jet<Shape>(all), chain_part(all), batch);
  }

  /// Applies T to jets that contain undeformed positions s and columns J. All parameters are constants here.
  void deform(const ParameterValues<double>& values, JetBatch<Pack>& batch) const override {
    static constexpr bool none[kMaxParameters] = {};
    const LinkParameters<double> constant{values.b.data(), values.b_dot.data(), none};
    chain_.apply(half_height_jet<Shape>(constant), chain_part(constant), batch);
  }
  /// Returns the position that T maps to p.
  Vec3<double> inverse_chain(const Vec3<double>& p, const ParameterValues<double>& values) const override {
    return chain_.inverse(p, shape().half_height(values.b.data()), values.b.data() + shape_size<Shape>);
  }

  /// Returns the parameters b of the chain, which are stored after the parameters a of the shape.
  template <class P>
  static LinkParameters<P> chain_part(const LinkParameters<P>& all) {
    constexpr int n = shape_size<Shape>;
    return {all.b + n, all.b_dot + n, all.dynamic + n};
  }

  GlobalDeform chain_;
};

}  // namespace pliant
