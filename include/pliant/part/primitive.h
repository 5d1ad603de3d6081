// Primitive<Shape, GlobalDeform>: the class of a part (design section 3). It computes s and J, Eqs. (3) and
// (4), for batches of material points; everything else is Part.
#pragma once

#include <pliant/deform/any_chain.h>
#include <pliant/part/part.h>
#include <pliant/part/shape_jets.h>

namespace pliant {

template <class Shape, class GlobalDeform = Chain<>>
class Primitive final : public Part {
 public:
  /// density: kg/m^3 of a solid, kg/m^2 of a shell.
  explicit Primitive(std::string name, double density = 1000, GlobalDeform chain = {})
      : Part(std::move(name), density, std::make_unique<ShapeFaceOf<Shape>>(), chain.links()),
        chain_(std::move(chain)) {}

  void jets(const ParameterValues<double>& values, const Material<Pack>* at,
            JetBatch<Pack>& batch) const override {
    evaluate(values, at, batch);
  }
  using Part::jets;
  void jets(const ParameterValues<Dual<1>>& values, const Material<Dual<1, Pack>>* at,
            JetBatch<Dual<1, Pack>>& batch) const override {
    evaluate(values, at, batch);
  }

 private:
  template <class P, class S>
  void evaluate(const ParameterValues<P>& values, const Material<S>* at, JetBatch<S>& batch) const {
    const LinkParameters<P> all{values.b.data(), values.b_dot.data(), parameters().dynamic_flags()};
    shape_jets<Shape>(all, at, batch);
    if (chain_.acts(after_shape(all))) chain_.apply(half_height_jet<Shape>(all), after_shape(all), batch);
  }
  template <class P>
  static LinkParameters<P> after_shape(const LinkParameters<P>& all) {
    constexpr int n = shape_size<Shape>;
    return {all.b + n, all.b_dot + n, all.dynamic + n};
  }
  void deform(const ParameterValues<double>& values, JetBatch<Pack>& batch) const override {
    static constexpr bool none[kMaxParameters] = {};
    const LinkParameters<double> held{values.b.data(), values.b_dot.data(), none};
    chain_.apply(half_height_jet<Shape>(held), after_shape(held), batch);
  }
  Vec3<double> undeform(const Vec3<double>& p, const ParameterValues<double>& values) const override {
    return chain_.inverse(p, shape().half_height(values.b.data()), values.b.data() + shape_size<Shape>);
  }

  GlobalDeform chain_;
};

}  // namespace pliant
