// Derivatives by central differences of sixth order, for functions evaluated in long double: with a step of
// 1e-3 of the scale on which a function varies they carry some 15 digits.
#pragma once

namespace pliant::test {

/// df/dt at t = 0; F: long double -> anything with + and * by a number.
template <class F>
auto first_derivative(F&& f, long double h) {
  using V = decltype(f(h));
  auto odd = [&](long double k) -> V { return f(k * h) - f(-k * h); };
  const V one = odd(1), two = odd(2), three = odd(3);
  return V((one * 45.0L - two * 9.0L + three) * (1 / (60 * h)));
}

/// d2f/dt2 at t = 0.
template <class F>
auto second_derivative(F&& f, long double h) {
  using V = decltype(f(h));
  auto even = [&](long double k) -> V { return f(k * h) + f(-k * h); };
  const V one = even(1), two = even(2), three = even(3), middle = f(0.0L);
  return V((one * 270.0L - two * 27.0L + three * 2.0L - middle * 490.0L) * (1 / (180 * h * h)));
}

}  // namespace pliant::test
