// The lightness of the colour map (0 to 100) increases along the map and differs by less than 6 from a linear
// function. The colour differences of equal steps differ by less than a factor of 3.5. Ticks of scales are
// round numbers.
#include <pliant/render/color_map.h>

#include <cmath>

#include "catch.h"

#include <pliant/render/ticks.h>

namespace color_map_test {

using namespace pliant;

namespace {

double linear(double channel) {
  return channel <= 0.04045 ? channel / 12.92 : std::pow((channel + 0.055) / 1.055, 2.4);
}

// Returns L* a* b* (CIE 1976) of an sRGB colour under D65.
Eigen::Vector3d lab(const Eigen::Vector3f& srgb) {
  const double r = linear(srgb[0]), g = linear(srgb[1]), b = linear(srgb[2]);
  const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  const double x = f((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047);
  const double y = f(0.2126729 * r + 0.7151522 * g + 0.0721750 * b);
  const double z = f((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

}  // namespace

TEST_CASE("lightness increases almost linearly along the colour map") {
  constexpr int steps = 100;
  const double dark = lab(mapped_color(0))[0], light = lab(mapped_color(1))[0];
  CHECK(dark < 20);
  CHECK(light > 88);
  double before = dark;
  for (int i = 1; i <= steps; ++i) {
    const double level = static_cast<double>(i) / steps, here = lab(mapped_color(level))[0];
    CAPTURE(level);
    CHECK(here > before + 0.3 * (light - dark) / steps);
    CHECK(std::abs(here - (dark + level * (light - dark))) < 6);
    before = here;
  }
}

TEST_CASE("colour differences of equal steps differ by less than a factor of 3.5") {
  constexpr int steps = 20;
  double least = 1e9, most = 0;
  for (int i = 0; i < steps; ++i) {
    const double far =
        (lab(mapped_color((i + 1.0) / steps)) - lab(mapped_color(static_cast<double>(i) / steps))).norm();
    least = std::min(least, far);
    most = std::max(most, far);
  }
  CHECK(most < 3.5 * least);
}

TEST_CASE("levels outside the scale have its first or last colour") {
  CHECK(mapped_color(-3) == mapped_color(0));
  CHECK(mapped_color(1.5) == mapped_color(1));
  for (int i = 0; i < kMapColors; ++i) {
    const Eigen::Vector3f color = mapped_color(static_cast<double>(i) / (kMapColors - 1));
    CHECK(color.minCoeff() >= 0);
    CHECK(color.maxCoeff() <= 1);
  }
}

TEST_CASE("ticks are round numbers with the necessary digits") {
  const auto labels = [](double low, double high) {
    std::string all;
    for (const Tick& tick : ticks(low, high)) {
      CHECK(tick.value >= low - 1e-9 * (high - low));
      CHECK(tick.value <= high + 1e-9 * (high - low));
      all += tick.label + " ";
    }
    return all;
  };
  CHECK(labels(0, 0.2) == "0 0.05 0.10 0.15 0.20 ");
  CHECK(labels(0, 1) == "0 0.2 0.4 0.6 0.8 1.0 ");
  CHECK(labels(0, 35) == "0 5 10 15 20 25 30 35 ");
  CHECK(labels(-0.3, 0.1) == "-0.3 -0.2 -0.1 0 0.1 ");
  CHECK(labels(0, 2e-6) == "0 5e-07 1.0e-06 1.5e-06 2.0e-06 ");
  CHECK(labels(0, 5e8) == "0 1e+08 2e+08 3e+08 4e+08 5e+08 ");
  CHECK(labels(7.1, 7.3) == "7.10 7.15 7.20 7.25 7.30 ");
}

}  // namespace color_map_test
