// A user's program. The warning flags of pliant must not reach this program; they would report its unused
// parameters. The option for the layout of Eigen's types must reach this program.
#include <cmath>

#include <pliant/math/scalar/dual.h>
#include <pliant/math/time_function.h>

#if EIGEN_MAX_STATIC_ALIGN_BYTES != 16
#error "pliant's options did not reach its client"
#endif

int main(int argc, char** argv) {
  // The results are the derivative of x sin x at x = 2, and a value of a spline through key frames.
  using Dual = pliant::Dual<1>;
  const Dual x = Dual::variable(2.0, 0);
  const Dual y = x * sin(x);
  const pliant::TimeFunction level = pliant::TimeFunction::key_frames({0, 1}, {3, 3});
  const bool right = std::abs(y.d[0] - (std::sin(2.0) + 2 * std::cos(2.0))) < 1e-15 && level.value(0.5) == 3;
  return right ? 0 : 1;
}
