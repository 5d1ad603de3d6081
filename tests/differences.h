// Derivatives by central differences of tenth order, for functions in long double. With a step of 1e-3 of the
// scale on which a function varies, about 15 digits of the first derivative and 12 of the second are correct
// (80-bit long double).
#pragma once

namespace pliant::test {

/// Returns df/dt at t = 0. f: function of t (long double), whose values can be added, subtracted and
/// multiplied by a number; h: step of t.
template <class F>
auto first_derivative(F&& f, long double h) {
  using V = decltype(f(h));
  auto odd = [&](long double k) -> V { return f(k * h) - f(-k * h); };
  const V one = odd(1), two = odd(2), three = odd(3), four = odd(4), five = odd(5);
  return V((one * 2100.0L - two * 600.0L + three * 150.0L - four * 25.0L + five * 2.0L) * (1 / (2520 * h)));
}

/// Returns d2f/dt2 at t = 0. The arguments are those of first_derivative().
template <class F>
auto second_derivative(F&& f, long double h) {
  using V = decltype(f(h));
  auto even = [&](long double k) -> V { return f(k * h) + f(-k * h); };
  const V one = even(1), two = even(2), three = even(3), four = even(4), five = even(5), middle = f(0.0L);
  return V(
      (one * 42000.0L - two * 6000.0L + three * 1000.0L - four * 125.0L + five * 8.0L - middle * 73766.0L) *
      (1 / (25200 * h * h)));
}

}  // namespace pliant::test
