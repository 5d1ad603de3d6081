// Helpers for the tests of motion: runs of simulations, functions of time with exact derivatives, models.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include <pliant/deform/all_deforms.h>
#include <pliant/part/registry.h>
#include <pliant/shape/all_shapes.h>
#include <pliant/simulate/simulation.h>

namespace pliant::test {

/// Advances a simulation by `end` seconds in `steps` equal steps.
inline void run(Simulation& simulation, double end, int steps) {
  for (int i = 0; i < steps; ++i) simulation.step(end / steps);
}

/// Returns the function mean + amplitude sin(rate t + phase) of the time t (s). rate: rad/s; phase: rad.
inline TimeFunction wave(double mean, double amplitude, double rate, double phase = 0) {
  struct Wave : TimeFunction::Impl {
    double mean, amplitude, rate, phase;
    Taylor2<double> at(double t) const override {
      const double s = amplitude * std::sin(rate * t + phase), c = amplitude * std::cos(rate * t + phase);
      return {mean + s, rate * c, -rate * rate * s};
    }
  };
  auto impl = std::make_shared<Wave>();
  impl->mean = mean;
  impl->amplitude = amplitude;
  impl->rate = rate;
  impl->phase = phase;
  return TimeFunction(impl);
}

/// Returns the slope of log(error) over log(step), by least squares. The step of each error is half the step
/// of the previous error.
inline double observed_order(const std::vector<double>& errors) {
  const double n = static_cast<double>(errors.size());
  double x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double a = -static_cast<double>(i), b = std::log2(errors[i]);
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

/// Returns the complete elliptic integral K(m), m = sin^2(theta / 2), by the arithmetic-geometric mean. A
/// pendulum with the amplitude theta (rad) has the period 4 K sqrt(length / g).
inline double elliptic_K(double theta) {
  double a = 1, b = std::cos(theta / 2);
  while (std::abs(a - b) > 1e-15 * a) {
    const double mean = (a + b) / 2;
    b = std::sqrt(a * b);
    a = mean;
  }
  return kPi / (2 * a);
}

/// Adds a part and returns it. shape: name of its shape; chain: names of its deformations; density: kg/m^3.
inline Part& add(MultiBody& body, const std::string& name, const std::string& shape,
                 const std::vector<std::string>& chain, double density) {
  return body.add(make_part(name, shape, chain, density));
}

/// Adds a moving ellipsoid with taper, twist, shear and bend, and returns this part. All of its parameters
/// are dynamic and have a stiffness. Sets the gravity of the MultiBody to zero.
inline Part& tumbling_solid(MultiBody& body, const std::string& name = "solid") {
  body.gravity.setZero();
  Part& part = add(body, name, "ellipsoid", {"taper", "twist", "shear", "bend"}, 1000);
  part.rest(
      {{"a1", 0.3}, {"a2", 0.25}, {"a3", 0.6}, {"taper.tx", 0.2}, {"twist.angle", 0.3}, {"bend.angle", 0.4}});
  part.stiffness({{"a1", 4e4},
                  {"a2", 5e4},
                  {"a3", 2e4},
                  {"taper.tx", 300},
                  {"taper.ty", 250},
                  {"twist.angle", 200},
                  {"shear.sx", 900},
                  {"shear.sy", 1000},
                  {"bend.angle", 500},
                  {"bend.direction", 60}});
  part.initial({{"a1", 0.32}, {"twist.angle", 0.6}, {"bend.angle", 0.6}, {"bend.direction", 0.3}});
  part.initial_rate({{"a2", 0.2}, {"a3", -0.3}, {"taper.tx", 0.5}, {"taper.ty", -0.7}, {"shear.sx", 0.4}});
  part.place({0.1, -0.2, 0.3}, Eigen::Quaterniond(0.8, 0.1, -0.5, 0.2));
  part.velocity({0.5, -0.3, 0.2}, {2, -1.5, 1});
  return part;
}

}  // namespace pliant::test
