// An independent evaluation of a part, in long double and by finite differences. It uses the formulas of the
// shape and of the global deformations only, without the derivatives, batches and sums of the engine.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <pliant/deform/all_deforms.h>
#include <pliant/part/part.h>
#include <pliant/shape/all_shapes.h>

#include "differences.h"

namespace pliant::test {

using Long = long double;

inline Trig<Long> widen(const Trig<double>& t) {
  return {t.x, t.sign, t.sign != 0 ? static_cast<Long>(t.log_abs) : static_cast<Long>(kLogZero)};
}
inline Material<Long> widen(const Material<double>& m) {
  return {widen(m.cu), widen(m.su), widen(m.cv), widen(m.sv), m.w};
}

namespace detail {
/// If `name` is this shape, sets the position s and the half height h, moves b past the parameters of the
/// shape, and returns true.
template <class Shape>
bool shape_point(const std::string& name, const Material<Long>& m, const Long*& b, Vec3<Long>& s, Long& h) {
  if (name != Shape::name) return false;
  const ShapeVec<Shape, Long> a = Eigen::Map<const ShapeVec<Shape, Long>>(b);
  s = Shape::template e<Long>(m, a);
  h = Shape::template half_height<Long>(a);
  b += shape_size<Shape>;
  return true;
}
/// If `name` is this deformation, applies it to s, moves b past its parameters, and returns true.
template <class Deform>
bool link_point(const std::string& name, const Long*& b, Vec3<Long>& s, const Long& h) {
  if (name != Deform::name) return false;
  s = Deform::template apply<Long>(
      Vec3<Long>(s), h, Vec<Long, deform_size<Deform>>(Eigen::Map<const Vec<Long, deform_size<Deform>>>(b)));
  b += deform_size<Deform>;
  return true;
}
template <class... Shapes>
void shape_of(std::tuple<Shapes...>*, const std::string& name, const Material<Long>& m, const Long*& b,
              Vec3<Long>& s, Long& h) {
  (void)(shape_point<Shapes>(name, m, b, s, h) || ...);
}
template <class... Links>
void link_of(std::tuple<Links...>*, const std::string& name, const Long*& b, Vec3<Long>& s, const Long& h) {
  (void)(link_point<Links>(name, b, s, h) || ...);
}
}  // namespace detail

/// Returns s at a material point. parameters: all parameters of the part, in order.
inline Vec3<Long> reference_point(const Part& part, const Material<Long>& m,
                                  const std::vector<Long>& parameters) {
  const Long* b = parameters.data();
  Vec3<Long> s;
  Long h = 0;
  detail::shape_of(static_cast<AllShapes*>(nullptr), part.shape().name(), m, b, s, h);
  for (const LinkInfo& link : part.parameters().all_links())
    detail::link_of(static_cast<AllDeforms*>(nullptr), link.type, b, s, h);
  return s;
}

/// Reference values at a material point: s; its first and second time derivatives s1 = J q_s_dot and
/// s2 = Jdot q_s_dot, for constant q_s_dot; and J.
struct ReferencePoint {
  Vec3<double> s, s1, s2;
  Eigen::Matrix3Xd J;
};

class Reference {
 public:
  /// part: must outlive this object. q_s, q_s_dot: values and rates of its dynamic parameters.
  Reference(const Part& part, const VecMax<double>& q_s, const VecMax<double>& q_s_dot)
      : part_(part), q_s_(q_s), q_s_dot_(q_s_dot) {
    const ParameterValues<double> rest = part.parameters().rest();
    for (int i = 0; i < part.parameters().size(); ++i) all_.push_back(rest.b[static_cast<std::size_t>(i)]);
    for (int k = 0; k < q_s.size(); ++k) all_[dynamic(k)] = q_s[k];
  }

  ReferencePoint at(const Material<double>& material) const {
    const Material<Long> m = widen(material);
    ReferencePoint r;
    r.s = reference_point(part_, m, all_).cast<double>();
    r.J.resize(3, q_s_.size());
    for (int k = 0; k < q_s_.size(); ++k) {
      auto along = [&](Long t) {
        std::vector<Long> moved = all_;
        moved[dynamic(k)] += t;
        return reference_point(part_, m, moved);
      };
      r.J.col(k) = first_derivative(along, 3e-4L * std::max(std::abs(q_s_[k]), 0.2)).cast<double>();
    }
    auto path = [&](Long t) {
      std::vector<Long> moved = all_;
      for (int k = 0; k < q_s_.size(); ++k) moved[dynamic(k)] += t * q_s_dot_[k];
      return reference_point(part_, m, moved);
    };
    r.s1 = first_derivative(path, 5e-4L).cast<double>();
    r.s2 = second_derivative(path, 2e-3L).cast<double>();
    return r;
  }

 private:
  std::size_t dynamic(int k) const {
    return static_cast<std::size_t>(part_.parameters().dynamic()[static_cast<std::size_t>(k)]);
  }

  const Part& part_;
  VecMax<double> q_s_, q_s_dot_;
  std::vector<Long> all_;
};

}  // namespace pliant::test
