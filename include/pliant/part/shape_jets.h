// The kernel of a shape: the positions e(u; a), Eq. (3), of a batch of material points u, with first and
// second derivatives by t along the parameters a + t a_dot. The Jacobian de/da for the dynamic parameters
// gives the first columns of J, Eq. (9). The links of the chain then transform these columns (deform/link.h).
#pragma once

#include <type_traits>

#include <pliant/deform/jet.h>
#include <pliant/deform/link.h>
#include <pliant/math/scalar/inline_all.h>
#include <pliant/shape/shape.h>

namespace pliant {

/// Fills the batch if parameter a_k is the only dynamic parameter of the shape. At Level::rates one Taylor2
/// number in a_k gives e, J, s1 and s2; at Level::jacobian a dual number in a_k gives e and J.
template <class Shape, class P, class S, class U>
void shape_jets_alone(int k, const LinkParameters<P>& parameters, const Material<U>* material,
                      JetBatch<S>& batch) {
  auto evaluate = [&](auto along, auto&& store) {
    using T = decltype(along);
    Vec<T, shape_size<Shape>> a;
    for (int i = 0; i < shape_size<Shape>; ++i) a[i] = i == k ? along : T(S(parameters.b[i]));
    for (int i = 0; i < batch.count; ++i) {
      const Material<U> m = material[i];
      const Vec3<T> e = Shape::template e<T>(m, a);
      Jet<S>& jet = batch.jet[i];
      for (int r = 0; r < 3; ++r) {
        jet.s[r] = e[r].v;
        store(jet, r, e[r]);
      }
    }
  };
  const S a(parameters.b[k]), rate(parameters.b_dot[k]), rate2(rate * rate);
  if (batch.level == Level::rates)
    evaluate(Taylor2<S>(a, S(1.0), S(0.0)), [&](Jet<S>& jet, int r, const Taylor2<S>& e) {
      jet.J[0][r] = e.d;
      jet.s1[r] = rate * e.d;
      jet.s2[r] = rate2 * e.dd;
    });
  else
    evaluate(Dual<1, S>::variable(a, 0),
             [](Jet<S>& jet, int r, const Dual<1, S>& e) { jet.J[0][r] = e.d[0]; });
  batch.n_columns = 1;
}

/// Implements shape_jets().
template <class Shape, class P, class S, class U>
void fill_shape_jets(const LinkParameters<P>& parameters, const Material<U>* material, JetBatch<S>& batch) {
  constexpr int K = shape_size<Shape>;
  Vec<S, K> a;
  int n_dynamic = 0, last = 0;
  for (int k = 0; k < K; ++k) {
    a[k] = S(parameters.b[k]);
    if (parameters.dynamic[k]) last = k;
    n_dynamic += parameters.dynamic[k] ? 1 : 0;
  }
  if (batch.level == Level::position || n_dynamic == 0) {
    for (int i = 0; i < batch.count; ++i) {
      Jet<S>& jet = batch.jet[i];
      jet.s = Shape::template e<S>(material[i], a);
      jet.s1.setConstant(S(0.0));
      jet.s2.setConstant(S(0.0));
    }
    batch.n_columns = 0;
    return;
  }
  if (n_dynamic == 1) return shape_jets_alone<Shape>(last, parameters, material, batch);
  using T = Taylor2<S>;
  using D = Dual<K, S>;
  Vec<T, K> a_t;
  Vec<D, K> a_d;
  for (int k = 0; k < K; ++k) {
    a_t[k] = parameters.dynamic[k] ? T(a[k], S(parameters.b_dot[k]), S(0.0)) : T(a[k]);
    a_d[k] = D::variable(a[k], k);
  }
  // One pass computes J and the rates, so that the compiler computes their common subexpressions once.
  auto evaluate = [&](auto rates) {
    for (int i = 0; i < batch.count; ++i) {
      const Material<U> m = material[i];
      Vec3<T> e_t;
      if constexpr (rates) e_t = Shape::template e<T>(m, a_t);
      const Vec3<D> e_d = Shape::template e<D>(m, a_d);
      Jet<S>& jet = batch.jet[i];
      for (int r = 0; r < 3; ++r) {
        jet.s[r] = e_d[r].v;
        if constexpr (rates) {
          jet.s1[r] = e_t[r].d;
          jet.s2[r] = e_t[r].dd;
        }
      }
      std::size_t column = 0;
      for (int k = 0; k < K; ++k) {
        if (!parameters.dynamic[k]) continue;
        for (int r = 0; r < 3; ++r) jet.J[column][r] = e_d[r].d[static_cast<std::size_t>(k)];
        ++column;
      }
    }
  };
  if (batch.level == Level::rates)
    evaluate(std::true_type{});
  else
    evaluate(std::false_type{});
  batch.n_columns = n_dynamic;
}

/// Fills the batch with e and, if batch.level requires them, J and the rates s1 = J a_dot and s2 = Jdot
/// a_dot. Sets the number of columns of J. If no parameter of the shape is dynamic, or at Level::position, s1
/// and s2 are zero and J has no columns. P: scalar of the parameters; S: scalar of the jets; U: scalar of the
/// material points.
template <class Shape, class P, class S, class U>
void shape_jets(const LinkParameters<P>& parameters, const Material<U>* material, JetBatch<S>& batch) {
  inline_all_if<std::is_same_v<P, double>>([&] { fill_shape_jets<Shape>(parameters, material, batch); });
}

/// Returns the half height h(a), its first and second derivatives by t along a + t a_dot, and its derivatives
/// by the dynamic parameters.
template <class Shape, class P>
HalfHeight<P> half_height_jet(const LinkParameters<P>& parameters) {
  constexpr int K = shape_size<Shape>;
  Vec<Taylor2<P>, K> a_t;
  using D = Dual<K, P>;
  Vec<D, K> a_d;
  int n_dynamic = 0;
  for (int k = 0; k < K; ++k) {
    const P& a = parameters.b[k];
    a_t[k] = parameters.dynamic[k] ? Taylor2<P>(a, parameters.b_dot[k], P(0.0)) : Taylor2<P>(a);
    a_d[k] = D::variable(a, k);
    n_dynamic += parameters.dynamic[k] ? 1 : 0;
  }
  HalfHeight<P> half;
  half.h = Shape::template half_height<Taylor2<P>>(a_t);
  const D h = Shape::template half_height<D>(a_d);
  half.slope.resize(n_dynamic);
  int column = 0;
  for (int k = 0; k < K; ++k)
    if (parameters.dynamic[k]) half.slope[column++] = h.d[static_cast<std::size_t>(k)];
  return half;
}

}  // namespace pliant
