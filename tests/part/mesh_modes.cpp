// The lowest modes of a mesh agree whichever library factors its matrix, Eigen or CHOLMOD.
#include <pliant/part/local/local_laws.h>
#include <pliant/part/primitive.h>
#include <pliant/shape/sphere.h>
#include <pliant/solve/cholmod_factor.h>

#include "catch.h"

namespace mesh_modes_test {

using namespace pliant;

namespace {

/// Returns omega^2 of the modes of a ball of curved elements; `make` creates the factorisation.
VecX<double> frequencies(MakeSparseFactor make) {
  LocalSettings settings;
  settings.basis = LocalSettings::Basis::modes;
  settings.modes = 12;
  settings.resolution = 2;
  settings.order = 2;
  settings.energies = {local_law("elastic", {1e5, 0.3})};
  settings.make_factor = std::move(make);
  Primitive<Sphere> ball("ball", 1000);
  ball.rest({{"r", 0.1}}).deform_locally(settings);
  ball.prepare();
  return ball.local()->oscillators()->omega2;
}

}  // namespace

TEST_CASE("modes of a mesh by CHOLMOD and by Eigen agree") {
  int made = 0;
  const VecX<double> by_eigen = frequencies(make_eigen_factor);
  const VecX<double> by_cholmod = frequencies([&] {
    ++made;
    return make_cholmod_factor();
  });
  CHECK(made == 1);
  REQUIRE(by_eigen.size() == 12);
  // The differences are errors of the eigensolver.
  CHECK((by_cholmod - by_eigen).lpNorm<Eigen::Infinity>() <= 1e-10 * by_eigen.maxCoeff());
}

}  // namespace mesh_modes_test
