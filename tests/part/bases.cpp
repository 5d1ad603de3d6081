// Global bases of local deformation (polynomials, modes): orthogonality; the modes of Lamb's sphere, of
// cylinders and of meshes. Lamb's sphere is a free solid sphere (Lamb 1882) with torsional modes T1, T2, ...
// and spheroidal modes S1, S2, ...; the number is the degree of the spherical harmonic.
#include "catch.h"

#include <array>

#include <pliant/deform/all_deforms.h>
#include <pliant/part/local/local_laws.h>
#include <pliant/part/local/modal_deformation.h>
#include <pliant/part/local/nodal_deformation.h>
#include <pliant/part/registry.h>

namespace bases_test {

using namespace pliant;

namespace {

using Basis = LocalSettings::Basis;

LocalSettings polynomials(int degree, double nu = 0.3) {
  LocalSettings settings;
  settings.basis = Basis::polynomial;
  settings.degree = degree;
  settings.resolution = 2;
  settings.energies = {local_law("elastic", {2 * (1 + nu), nu})};  // mu = 1
  return settings;
}

const ModalDeformation& modal(const Part& part) {
  return dynamic_cast<const ModalDeformation&>(*part.local());
}

/// Returns omega r / c_t of the modes of a unit sphere; c_t = 1 is the speed of shear waves.
VecX<double> etas(int degree, double nu = 0.3) {
  const auto part = make_part("ball", "sphere", {}, 1);
  part->rest({{"r", 1}}).deform_locally(polynomials(degree, nu));
  part->prepare();
  return modal(*part).basis().omega2.cwiseSqrt();
}

/// Relative errors of the mean frequencies of the five modes T2, the five modes S2 and the three modes S1.
struct LambErrors {
  double T2, S2, S1;
};
LambErrors lamb(const VecX<double>& eta) {
  return {eta.segment(0, 5).mean() / 2.50113 - 1, eta.segment(5, 5).mean() / 2.64622 - 1,
          eta.segment(10, 3).mean() / 3.52999 - 1};
}
LambErrors lamb(int degree) {
  return lamb(etas(degree));
}

std::string refusal(Part& part, const LocalSettings& settings) {
  try {
    part.deform_locally(settings);
    part.prepare();
  } catch (const std::invalid_argument& failure) {
    return failure.what();
  }
  return {};
}

}  // namespace

TEST_CASE(
    "modes are orthonormal with the mass, and orthogonal to rigid motion and the fields of the parameters",
    "[bases][long]") {
  for (const Basis kind : {Basis::polynomial, Basis::modes})
    for (const char* shape : {"ellipsoid", "superellipsoid", "cylinder", "cone", "supertoroid"}) {
      CAPTURE(shape, static_cast<int>(kind));
      const auto part = make_part("soft", shape, {"taper", "twist"}, 3);
      part->rest({{"taper.tx", 0.2}, {"twist.angle", 0.3}}).make_dynamic({"a3", "twist.angle"});
      LocalSettings settings = polynomials(3);
      settings.basis = kind;
      settings.modes = 12;
      part->deform_locally(settings);
      part->prepare();
      const ModalBasis& basis = modal(*part).basis();
      const Eigen::Index n = basis.B.cols();
      const VecX<double> M = basis.mass.replicate(3, 1);
      CHECK((basis.B.transpose() * M.asDiagonal() * basis.B - MatX<double>::Identity(n, n)).norm() <= 1e-11);
      CHECK(basis.omega2.minCoeff() > 0);
      CHECK(std::is_sorted(basis.omega2.begin(), basis.omega2.end()));

      // The columns of W belong to the fields of rigid motion and of the parameters. Each column is M times
      // the values of its field at the points of the basis, projected onto the functions of the basis.
      VecX<double> q_s(2);
      q_s << part->parameters().moving(0).rest_value(), part->parameters().moving(1).rest_value();
      std::vector<PointJet<double>> jets;
      Counters unused;
      part->points(basis.points, q_s, VecX<double>::Zero(2), jets, unused);
      MatX<double> W(3 * basis.mass.size(), 8);
      for (int c = 0; c < 8; ++c) {
        Nodes field(basis.points_at_rest.rows(), 3);
        for (Eigen::Index k = 0; k < field.rows(); ++k) {
          const Vec3<double> X = basis.points_at_rest.row(k).transpose();
          const Vec3<double> value = c < 3   ? Vec3<double>(Vec3<double>::Unit(c))
                                     : c < 6 ? Vec3<double>(Vec3<double>::Unit(c - 3).cross(X))
                                             : Vec3<double>(jets[static_cast<std::size_t>(k)].J.col(c - 6));
          field.row(k) = value.transpose();
        }
        W.col(c) = M.asDiagonal() * Nodes(basis.project * field).reshaped();
      }
      W.colwise().normalize();
      const double scale = std::sqrt(basis.mass[0]);
      CHECK((W.transpose() * basis.B).cwiseAbs().maxCoeff() * scale <= 1e-10 * std::max(1.0, scale));
    }
}

TEST_CASE("Lamb's sphere by polynomials: T2, S2, S1 and breathing converge with every second degree",
          "[bases]") {
  const LambErrors three = lamb(3), four = lamb(4), five = lamb(5), six = lamb(6), seven = lamb(7);
  CAPTURE(three.T2, four.T2, five.T2, six.T2, three.S2, four.S2, five.S2, seven.S2, four.S1, five.S1, six.S1);
  CHECK(std::abs(four.T2) <= 1.7e-4);
  CHECK(std::abs(five.S2) <= 8e-6);
  CHECK(std::abs(six.T2) <= 4e-6);
  CHECK(std::abs(seven.S2) <= 3e-6);
  CHECK(std::abs(six.S1) <= 2e-5);
  CHECK(std::abs(four.T2) <= 0.1 * std::abs(three.T2));
  CHECK(std::abs(five.S2) <= 0.1 * std::abs(four.S2));
  auto nearest = [](const VecX<double>& eta, double to) { return (eta.array() / to - 1).abs().minCoeff(); };
  CHECK(nearest(etas(5), 4.99551) <= 1e-4);
  CHECK(nearest(etas(7), 4.99551) <= 2e-6);
}

TEST_CASE("Lamb's sphere by modes of curved elements with consistent mass: fourth order, from above",
          "[bases][long]") {
  auto mesh_errors = [](int resolution) {
    const auto part = make_part("ball", "sphere", {}, 1);
    LocalSettings settings = polynomials(0);
    settings.basis = Basis::modes;
    settings.modes = 13;
    settings.resolution = resolution;
    settings.order = 2;
    part->rest({{"r", 1}}).deform_locally(settings);
    part->prepare();
    return lamb(modal(*part).basis().omega2.cwiseSqrt());
  };
  const LambErrors two = mesh_errors(2), three = mesh_errors(3), four = mesh_errors(4);
  auto order = [](double coarse, double fine) { return std::log(coarse / fine) / std::log(4.0 / 3.0); };
  CAPTURE(two.T2, three.T2, four.T2, two.S2, three.S2, four.S2, two.S1, three.S1, four.S1);
  for (double LambErrors::*of : {&LambErrors::T2, &LambErrors::S2, &LambErrors::S1}) {
    CHECK(four.*of > 0);
    CHECK(order(three.*of, four.*of) >= 3.6);
  }
  CHECK(four.T2 <= 1.5e-4);
  CHECK(four.S2 <= 5.2e-5);
}

TEST_CASE("polynomials do not lock near nu_P = 1/2", "[bases]") {
  const VecX<double> eta = etas(6, 0.49);
  CHECK(eta.segment(0, 5).mean() == Approx(2.50113).epsilon(1e-5));
  CHECK(eta.segment(5, 5).mean() == Approx(2.66483).epsilon(1e-4));
  const VecX<double> harder = etas(7, 0.4999);
  CHECK(harder.segment(0, 5).mean() == Approx(2.50113).epsilon(1e-5));
  CHECK(harder.segment(5, 5).mean() == Approx(2.6656).epsilon(1e-3));
}

TEST_CASE("a long cylinder by polynomials: frequencies of torsion and bending agree with those of a bar",
          "[bases]") {
  const auto part = make_part("bar", "cylinder", {}, 1);
  part->rest({{"a1", 1}, {"a2", 1}, {"a3", 5}}).deform_locally(polynomials(8));
  part->prepare();
  const VecX<double> omega = modal(*part).basis().omega2.cwiseSqrt();
  auto nearest = [&](double to) { return (omega.array() / to - 1).abs().minCoeff(); };
  // The shear modulus and the density are 1, so that the speed of torsional waves is c = 1. The frequencies
  // n pi c / L of torsion, with the length L = 10, are exact. The frequencies of bending are from
  // Timoshenko's beam with the radius L / 10.
  CHECK(nearest(kPi / 10) <= 1e-6);
  CHECK(nearest(2 * kPi / 10) <= 1e-4);
  const double unit = std::sqrt(2.6 / 4) / 100;  // sqrt(E I / (rho A)) / L^2 of the beam
  CHECK(omega[0] == Approx(20.3813 * unit).epsilon(5e-3));
  CHECK(omega[1] == Approx(omega[0]).epsilon(1e-6));
}

TEST_CASE("a long cylinder by polynomials of degree 10: three bending frequencies near those of Timoshenko",
          "[bases][long]") {
  // Frequencies as omega L^2 sqrt(rho A / (E I)). The values `solid` are the reference values of
  // tests/local/solid_modes.cpp; `beam` has those of Timoshenko's beam, and `beam_error` bounds its relative
  // errors.
  constexpr std::array<double, 3> beam{20.3813, 49.2314, 83.9790}, solid{20.41175, 49.4462, 84.565},
      beam_error{0.0016, 0.0046, 0.0072};
  const auto part = make_part("bar", "cylinder", {}, 1);
  part->rest({{"a1", 1}, {"a2", 1}, {"a3", 5}}).deform_locally(polynomials(10));
  part->prepare();
  const double unit = std::sqrt(2.6 / 4) / 100;  // sqrt(E I / (rho A)) / L^2
  const VecX<double> omega = modal(*part).basis().omega2.cwiseSqrt() / unit;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Index at = (omega.array() < (1 - 1e-5) * solid[k]).count();
    CHECK(omega[at] == Approx(solid[k]).epsilon(1e-5));
    CHECK(omega[at + 1] == Approx(omega[at]).epsilon(1e-6));  // one mode in each of two planes
    CHECK(omega[at] > beam[k]);
    CHECK(omega[at] / beam[k] - 1 <= beam_error[k]);
  }
}

TEST_CASE("modes of a mesh are those of its elements under the reference conditions", "[bases]") {
  for (const bool shell : {false, true}) {
    CAPTURE(shell);
    auto make_soft_ball = [&](Basis kind, int resolution, int modes) {
      auto part = make_part("ball", "ellipsoid", {}, 2);
      if (shell) part->make_shell();
      part->rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}}).make_dynamic({"a1"});
      LocalSettings settings;
      settings.basis = kind;
      settings.resolution = resolution;
      settings.modes = modes;
      settings.energies = {shell ? local_law("membrane", {1e3, 0.3, 0.01})
                                 : local_law("elastic", {1e3, 0.3})};
      part->deform_locally(settings);
      part->prepare();
      return part;
    };
    for (const int resolution : {2, 5}) {  // the dense solver, and the sparse one
      const auto nodal = make_soft_ball(Basis::nodes, resolution, 0),
                 part = make_soft_ball(Basis::modes, resolution, 15);
      const NodalDeformation& nodal_local = *nodal->local()->nodal();
      const ModalBasis& basis = modal(*part).basis();
      // K Phi = omega^2 M Phi, apart from forces along W of the reference conditions W^T d = 0
      // (include/pliant/part/local/README.md).
      const Eigen::Index n = nodal_local.n_nodes();
      for (Eigen::Index j = 0; j < 15; ++j) {
        const VecX<double> mode =
            modal(*part).displacements(VecX<double>::Unit(15, j).eval().data()).reshaped();
        VecX<double> f = VecX<double>::Zero(3 * n);
        NodalEnergy::Buffer buffer;
        nodal_local.energies()[0]->add_force(mode, f, buffer, nullptr);
        f += basis.omega2[j] * nodal_local.inertia().cwiseProduct(mode);
        // The residual is a linear combination of the seven columns of W = M G0; G0 has the fields of six
        // rigid motions and of a1.
        MatX<double> W = MatX<double>::Zero(3 * n, 7);
        const Nodes& X = nodal_local.mesh().X;
        for (int i = 0; i < 3; ++i) {
          W.col(i).segment(i * n, n).setOnes();
          W.col(3 + i).segment((i + 2) % 3 * n, n) = X.col((i + 1) % 3);
          W.col(3 + i).segment((i + 1) % 3 * n, n) = -X.col((i + 2) % 3);
        }
        W.col(6).head(n) = X.col(0);
        W = (nodal_local.inertia().asDiagonal() * W).eval();
        CHECK((W.transpose() * mode).norm() <= 1e-10 * W.norm() * mode.norm());
        f -= W * W.colPivHouseholderQr().solve(f);
        CHECK(f.norm() <= 1e-7 * basis.omega2[j] * nodal_local.inertia().cwiseProduct(mode).norm());
      }
    }
  }
}

TEST_CASE("weights of a material point give its displacement", "[bases]") {
  for (const Basis kind : {Basis::polynomial, Basis::modes}) {
    const auto part = make_part("ball", "ellipsoid", {"taper"}, 2);
    part->rest({{"taper.tx", 0.2}});
    LocalSettings settings = polynomials(4);
    settings.basis = kind;
    settings.resolution = 3;
    part->deform_locally(settings);
    part->prepare();
    const ModalDeformation& local = modal(*part);
    const VecX<double> q = VecX<double>::LinSpaced(local.n_d(), -1, 1);
    const Nodes displacements = local.displacements(q.data());
    VecX<double> buffer;
    for (std::size_t k = 0; k < local.mesh().nodes.size(); k += 5) {
      const NodeWeights at = local.weights(*part, local.mesh().nodes[k]);
      const VecX<double> d = at_points({at}, local.at_nodes(q.data(), buffer));
      CHECK((d - displacements.row(static_cast<Eigen::Index>(k)).transpose()).norm() <=
            1e-11 * displacements.norm());
    }
  }
}

TEST_CASE("invalid bases are refused with a message", "[bases][long]") {
  const auto shell = make_part("skin", "sphere", {}, 1);
  shell->make_shell();
  LocalSettings settings = polynomials(4);
  CHECK_THAT(refusal(*shell, settings), test::has_text("'skin'") && test::has_text("for solids"));
  const auto ball = make_part("ball", "sphere", {}, 1);
  settings.energies = {local_law("neo_hookean", {1e3, 0.3})};
  CHECK_THAT(refusal(*ball, settings), test::has_text("'neo_hookean'"));
  settings.basis = Basis::modes;
  CHECK_THAT(refusal(*ball, settings), test::has_text("'neo_hookean'"));
  settings.energies = {local_law("elastic", {1e3, 0.3})};
  settings.resolution = 1;
  settings.modes = 1000;
  CHECK_THAT(refusal(*ball, settings), test::has_text("1000 modes"));
  settings.resolution = 34;
  CHECK_THAT(refusal(*ball, settings), test::has_text("nodes are too many"));
  settings = polynomials(11);
  CHECK_THAT(refusal(*ball, settings), test::has_text("degree 11"));
}

}  // namespace bases_test
