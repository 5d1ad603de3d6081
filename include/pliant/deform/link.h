// One link of a chain, T(p, h; b), applied to a batch of jets. Dual numbers in the variables p, h and b
// give the derivatives F = dT/dp, T_h = dT/dh and G_T = dT/db. chain_columns() uses them to update J, the
// Jacobian of the reference shape s in Eq. (9) (README.md of this folder):
//   J <- [F J + T_h dh/da, G_T]
#pragma once

#include <type_traits>

#include <pliant/deform/deform.h>
#include <pliant/deform/jet.h>
#include <pliant/math/scalar/dual.h>
#include <pliant/math/scalar/inline_all.h>
#include <pliant/math/scalar/taylor2.h>

namespace pliant {

/// The half height h of the shape, an input of every link. P is the scalar of the parameters.
template <class P>
struct HalfHeight {
  Taylor2<P> h;                 ///< value (m) and first two time derivatives
  VecMax<P, kMaxGlobal> slope;  ///< dh/da for each dynamic parameter of the shape (first columns of J)
};

/// The parameters of one link.
template <class P>
struct LinkParameters {
  const P* b;           ///< values
  const P* b_dot;       ///< rates
  const bool* dynamic;  ///< whether each parameter is a degree of freedom
};

/// Returns whether a link acts: it is not the identity, or at least one of its parameters is dynamic. A link
/// that does not act is skipped.
template <class Deform, class P>
bool link_acts(const LinkParameters<P>& parameters) {
  for (int k = 0; k < deform_size<Deform>; ++k)
    if (parameters.dynamic[k]) return true;
  return !is_identity<Deform>(parameters.b);
}

/// Applies a link whose only dynamic parameter is parameter k to a batch of jets. The shape and all earlier
/// links must be frozen, so that the incoming positions are constant. At Level::rates, one Taylor2 number in
/// parameter k gives s, J, s1 and s2. At Level::jacobian, one dual number gives s and J.
template <class Deform, class P, class S>
void apply_link_alone(int k, const HalfHeight<P>& half, const LinkParameters<P>& parameters,
                      JetBatch<S>& batch) {
  auto each = [&](auto along, auto&& store) {
    using T = decltype(along);
    const T h(S(half.h.v));
    Vec<T, deform_size<Deform>> b;
    for (int i = 0; i < deform_size<Deform>; ++i) b[i] = i == k ? along : T(S(parameters.b[i]));
    const DeformBy<Deform, T> deform(h, b);
    for (int i = 0; i < batch.count; ++i) {
      Jet<S>& jet = batch.jet[i];
      const Vec3<T> moved = deform({T(jet.s[0]), T(jet.s[1]), T(jet.s[2])});
      for (int r = 0; r < 3; ++r) {
        jet.s[r] = moved[r].v;
        store(jet, r, moved[r]);
      }
    }
  };
  const S b(parameters.b[k]), rate(parameters.b_dot[k]), rate2(rate * rate);
  if (batch.level == Level::rates)
    each(Taylor2<S>(b, S(1.0), S(0.0)), [&](Jet<S>& jet, int r, const Taylor2<S>& moved) {
      jet.J[0][r] = moved.d;
      jet.s1[r] = rate * moved.d;
      jet.s2[r] = rate2 * moved.dd;
    });
  else
    each(Dual<1, S>::variable(b, 0),
         [](Jet<S>& jet, int r, const Dual<1, S>& moved) { jet.J[0][r] = moved.d[0]; });
  batch.n_columns = 1;
}

/// Updates the columns of J of one material point by the partial derivatives of one link, Eq. (9), and
/// appends one column for each dynamic parameter of the link. moved: T with its derivatives by p (directions
/// 0 to 2), h (direction 3) and b (from direction 4 on). n_columns: number of columns before the link.
template <int N, class P, class S>
void chain_columns(const Vec3<Dual<N, S>>& moved, const HalfHeight<P>& half,
                   const LinkParameters<P>& parameters, int n_columns, Jet<S>& jet) {
  const int n_shape = static_cast<int>(half.slope.size());
  for (int c = 0; c < n_columns; ++c) {
    const Vec3<S> column = jet.J[static_cast<std::size_t>(c)];
    for (int r = 0; r < 3; ++r) {
      S sum = moved[r].d[0] * column[0] + moved[r].d[1] * column[1] + moved[r].d[2] * column[2];  // F J
      if (c < n_shape) sum += moved[r].d[3] * S(half.slope[c]);                                   // T_h dh/da
      jet.J[static_cast<std::size_t>(c)][r] = sum;
    }
  }
  int next = n_columns;
  for (int k = 0; k < N - 4; ++k) {
    if (!parameters.dynamic[k]) continue;
    for (int r = 0; r < 3; ++r)
      jet.J[static_cast<std::size_t>(next)][r] = moved[r].d[static_cast<std::size_t>(k) + 4];  // G_T
    ++next;
  }
}

/// Implements apply_link() for a link that acts.
template <class Deform, class P, class S>
void transform_jets(const HalfHeight<P>& half, const LinkParameters<P>& parameters, JetBatch<S>& batch) {
  constexpr int K = deform_size<Deform>;
  const S h(half.h.v);
  Vec<S, K> b;
  int moving = 0, last = 0;
  for (int k = 0; k < K; ++k) {
    b[k] = S(parameters.b[k]);
    if (parameters.dynamic[k]) last = k;
    moving += parameters.dynamic[k] ? 1 : 0;
  }
  if (batch.level == Level::position || (batch.n_columns == 0 && moving == 0)) {
    const DeformBy<Deform, S> deform(h, b);
    for (int i = 0; i < batch.count; ++i) {
      Vec3<S>& s = batch.jet[i].s;
      s = deform(Vec3<S>(s));
    }
    return;
  }
  if (batch.n_columns == 0 && moving == 1) return apply_link_alone<Deform>(last, half, parameters, batch);

  using T = Taylor2<S>;
  using D = Dual<4 + deform_size<Deform>, S>;
  const T h_t(S(half.h.v), S(half.h.d), S(half.h.dd));
  const D h_d = D::variable(h, 3);
  Vec<T, K> b_t;
  Vec<D, K> b_d;
  for (int k = 0; k < K; ++k) {
    b_t[k] = parameters.dynamic[k] ? T(b[k], S(parameters.b_dot[k]), S(0.0)) : T(b[k]);
    b_d[k] = D::variable(b[k], 4 + k);
  }
  const DeformBy<Deform, T> deform_t(h_t, b_t);
  const DeformBy<Deform, D> deform_d(h_d, b_d);
  // One loop computes the time derivatives and the partial derivatives, so that the compiler shares their
  // common terms.
  auto each = [&](auto rates) {
    for (int i = 0; i < batch.count; ++i) {
      Jet<S>& jet = batch.jet[i];
      const Vec3<S> s = jet.s;
      Vec3<T> along;
      if constexpr (rates)
        along = deform_t(
            {T(s[0], jet.s1[0], jet.s2[0]), T(s[1], jet.s1[1], jet.s2[1]), T(s[2], jet.s1[2], jet.s2[2])});
      const Vec3<D> moved = deform_d({D::variable(s[0], 0), D::variable(s[1], 1), D::variable(s[2], 2)});
      for (int r = 0; r < 3; ++r) {
        jet.s[r] = moved[r].v;
        if constexpr (rates) {
          jet.s1[r] = along[r].d;
          jet.s2[r] = along[r].dd;
        }
      }
      chain_columns(moved, half, parameters, batch.n_columns, jet);
    }
  };
  if (batch.level == Level::rates)
    each(std::true_type{});
  else
    each(std::false_type{});
  batch.n_columns += moving;
}

/// Applies one link to a batch of jets: s <- T(s, h; b), J <- [F J + T_h dh/da, G_T]; the chain rule for the
/// first and second time derivatives gives s1 and s2. Computes only the quantities of batch.level. A link
/// that does not act changes nothing.
template <class Deform, class P, class S>
void apply_link(const HalfHeight<P>& half, const LinkParameters<P>& parameters, JetBatch<S>& batch) {
  if (link_acts<Deform>(parameters))
    inline_all_if<std::is_same_v<P, double>>([&] { transform_jets<Deform>(half, parameters, batch); });
}

}  // namespace pliant
